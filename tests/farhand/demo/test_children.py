"""Who writes has the time for it, and who does not end is killed and said to have been."""

import subprocess
import sys

import pytest

from farhand.common.timing.clock import SystemClock
from farhand.demo import children as module
from farhand.demo.children import Children
from farhand.demo.demo import _how

DEAF = "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); print(flush=True); input()"
WRITES = (
    "import signal; signal.signal(signal.SIGTERM, lambda *_: 0); print(flush=True); signal.pause(); input()"
)


@pytest.mark.realtime
def test_only_what_does_not_end_is_killed_and_that_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "PATIENCE", 0.2)
    found = Children(tmp_path, SystemClock())
    for name, code in (("record", WRITES), ("robot", DEAF)):
        found.running[name] = subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        assert found.running[name].stdout.readline()
    wait = found._wait

    def written_meanwhile(names, timeout):
        if "record" in names:  # all others are gone by now
            found.running["record"].stdin.write(b"\n")
            found.running["record"].stdin.flush()
        return wait(names, timeout)

    monkeypatch.setattr(found, "_wait", written_meanwhile)
    found.stop(patient=("record",))
    codes = found.ended()
    assert codes == {"record": 0, "robot": -9}
    assert _how("robot", -9, found) == (
        "the robot program did not end within 0.2 s of being asked to, and was killed"
    )
    for process in found.running.values():
        process.stdin.close()
        process.stdout.close()
