"""Virtual time waits for its recorder, which writes in a thread of its own."""

import threading

from farhand.common.recording import writer
from farhand.common.recording.reader import read_run
from farhand.common.recording.records import RunInfo
from farhand.common.recording.writer import RunRecorder
from farhand.testing import report
from farhand.testing.disk import ScriptedFile

INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={"python": "3"})


def test_it_waits_for_the_disk(monkeypatch):
    monkeypatch.setattr(writer, "WAITING_TICKS", 2)
    disk = ScriptedFile()
    recorder = RunRecorder(None, INFO, file=disk)
    for tick in range(200):
        recorder.tick(tick * 100_000_000, [], b"c%d" % tick, report(tick))
    recorder.close()
    run = read_run(disk)
    assert run.complete
    assert len(run.ticks) == 200
    assert (recorder.missing, recorder.trouble) == (0, "")
    assert disk.threads == {"recorder", threading.current_thread().name}  # the beginning and the end
