"""`farhand simulate`: what a person ends has a summary all the same."""

import errno
import json
import os
import signal

import pytest
from msgspec.structs import replace

from farhand.common.recording.reader import read_run
from farhand.laboratory import simulate_run as module
from farhand.laboratory.simulate_run import run_simulation
from farhand.laboratory.simulation import simulate, simulate_run
from farhand.runs.run import Run
from farhand.runs.scenario import load_scenario


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_it_with_the_summary_of_what_was(tmp_path, monkeypatch, capsys, number):
    def interrupted(run, **options):
        asked, stop = [0], options.pop("stop")

        def soon():
            asked[0] += 1
            if asked[0] == 100:
                os.kill(os.getpid(), number)
            return stop()

        return simulate_run(run, stop=soon, **options)

    monkeypatch.setattr(module, "simulate_run", interrupted)
    before = signal.getsignal(number)
    run = Run.over(load_scenario("point-obstacle"))
    assert run_simulation(run, out=tmp_path, as_json=True) == 1
    assert signal.getsignal(number) == before
    captured = capsys.readouterr()
    assert "INTERRUPTED" in captured.err.upper()
    summary = json.loads(captured.out.splitlines()[-1])
    assert (summary["why"], summary["finished"]) == ("interrupted", False)
    assert summary["ticks"] > 0
    assert summary == json.loads((tmp_path / "summary.json").read_text())
    assert read_run(tmp_path / "run.mcap").complete
    assert f"on one page: {tmp_path}/report.html" in captured.err
    assert "interrupted" in (tmp_path / "report.html").read_text()


def test_what_ends_before_it_began_is_interrupted_as_well():
    summary = simulate("point-obstacle", stop=lambda: True).summary
    assert (summary.why, summary.finished, summary.exit_code) == ("interrupted", False, 1)


def test_a_report_that_finds_no_place_costs_nothing_but_itself(tmp_path, monkeypatch, capsys):
    def full(path, content):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("farhand.report.write.write_whole", full)
    run = replace(Run.over(load_scenario("point-obstacle")), time_limit=0.3)
    assert run_simulation(run, out=tmp_path, as_json=False) == 1
    said = "".join(capsys.readouterr().out.split())  # a long path is broken anywhere
    assert "report.html:cannotbewritten:Nospaceleftondevice" in said
    assert (tmp_path / "summary.json").is_file()
    assert not (tmp_path / "report.html").exists()
