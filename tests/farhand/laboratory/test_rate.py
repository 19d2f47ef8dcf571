"""50 Hz end to end: what is sent, how well it is predicted, that it can be replayed, and who drives so by default."""

from itertools import pairwise

import pytest

from farhand.cli import run
from farhand.commands.options import chosen_scenario
from farhand.common.errors import InputError
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.recording.reader import read_run
from farhand.laboratory.replay import replay
from farhand.laboratory.simulation import simulate
from farhand.runs.scenario import load_scenario, replace_settings


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    path = tmp_path_factory.mktemp("rate") / "run.mcap"
    scenario = replace_settings(
        load_scenario("point-obstacle"), {"operator.rate_hz": 50.0, "guard.on": False}
    )
    options = {"network": "constant:200", "computing_time": 0.005, "time_limit": 6.0}
    result = simulate(scenario, **options, record_to=path, keep_reports=True)
    return path, result


def test_a_command_every_20_ms_whose_plan_has_the_papers_steps(driven):
    path, result = driven
    decoder = Decoder(VelocityCommand)
    commands = [decoder.decode(tick.command) for tick in read_run(path).ticks if tick.command]
    assert {b.t_sent_ns - a.t_sent_ns for a, b in pairwise(commands)} == {20_000_000}
    assert {(len(c.plan), c.plan_period_ns) for c in commands} == {(9, 100_000_000)}
    assert [c.seq for c in commands] == list(range(commands[0].seq, commands[0].seq + len(commands)))
    assert result.summary.period == 0.02
    assert result.summary.ticks >= 300


def test_over_a_constant_delay_every_prediction_is_right(driven):
    errors = [report.prediction_error for report in driven[1].reports]
    assert max(errors) < 1e-3
    assert max(report.rtt_mean or 0.0 for report in driven[1].reports) == pytest.approx(0.405, abs=0.005)


def test_it_replays_to_the_byte_and_keeps_its_rate(driven):
    found = replay(driven[0])
    assert found.identical
    assert len(found.judged) == driven[1].summary.ticks
    with pytest.raises(InputError, match=r"--set operator.rate_hz: a replay keeps the instants"):
        replay(driven[0], {"operator.rate_hz": 10.0})


def test_a_recording_with_windows_in_ticks_can_be_replayed(driven, monkeypatch):
    from farhand.laboratory import replay as module

    def as_of_before(path):
        run = read_run(path)
        margin = run.info.scenario["margin"]
        margin.update(rtt_window=30, innovation_window=100)
        del margin["rtt_span"], margin["innovation_span"]
        return run

    monkeypatch.setattr(module, "read_run", as_of_before)
    found = replay(driven[0])
    assert (found.scenario.margin.rtt_span, found.scenario.margin.innovation_span) == (3.0, 10.0)
    assert found.identical


def test_a_person_drives_at_50_hz_and_the_tester_at_the_papers_10():
    assert chosen_scenario("ur5-obstacle", None).operator.rate_hz is None
    assert chosen_scenario("ur5-obstacle", None, steer="remote").operator.rate_hz == 50.0
    assert chosen_scenario("ur5-obstacle", None, steer="remote", rate=20.0).operator.rate_hz == 20.0
    assert chosen_scenario("ur5-obstacle", ["operator.rate_hz=10"], steer="remote").operator.rate_hz == 10.0
    assert chosen_scenario("ur5-obstacle", None, rate=50.0).operator.rate_hz == 50.0


def test_a_rate_that_divides_no_step_is_refused_in_one_line(capsys):
    assert run(["simulate", "--scenario", "point-obstacle", "--rate", "33"]) == 2
    line = capsys.readouterr().err.strip()
    assert line.endswith("controller.period, 0.1 s, is no whole number of ticks at 33 Hz; 30 Hz would do")
    assert "\n" not in line
