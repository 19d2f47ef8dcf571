"""A recorded run, replayed: identical to the byte, and what another controller would have decided."""

import csv
import json
import re
from pathlib import Path

import msgspec
import pytest

from farhand.cli import run as run_cli
from farhand.common.errors import InputError
from farhand.common.recording.reader import read_run
from farhand.common.recording.run_file import RunFile
from farhand.laboratory.replay import RecordedSteering, differing_fields, replay
from farhand.laboratory.simulation import simulate
from farhand.operator_side.supervision import ESTOP_ASKED
from farhand.runs.scenario import load_scenario, replace_setting
from farhand.testing import report
from farhand.testing.disk import ScriptedFile
from tests.farhand.made_run import make_run


@pytest.fixture(scope="module")
def recordings(tmp_path_factory) -> dict[str, Path]:
    """A run with each margin over a network that delays, reorders and loses."""
    folder = tmp_path_factory.mktemp("recordings")
    found = {}
    for margin in ("none", "paper", "adaptive"):
        scenario = replace_setting(load_scenario("point-obstacle"), "margin.kind", margin)
        found[margin] = folder / f"{margin}.mcap"
        spec = "uniform:50,200 loss:10%"
        simulate(scenario, uplink=spec, downlink=spec, seed=3, time_limit=15.0, record_to=found[margin])
    return found


@pytest.mark.parametrize("margin", ["none", "paper", "adaptive"])
def test_every_decision_is_identical_to_the_byte(recordings, margin):
    result = replay(recordings[margin])
    assert len(result.ticks) > 140
    assert result.identical
    assert result.run.complete
    assert result.other_versions() == {}


def test_the_comparison_can_fail(recordings):
    result = replay(recordings["adaptive"], {"controller.gamma": 0.1})
    assert not result.identical
    first = result.first_difference
    assert first is not None
    assert "filtered" in differing_fields(first)


def test_the_same_settings_said_aloud_change_nothing(recordings):
    assert replay(recordings["paper"], {"margin.kind": "paper"}).identical


def test_another_margin_is_judged_from_the_commands_that_the_robot_got(recordings):
    result = replay(recordings["none"], {"margin.kind": "adaptive"})
    assert max(t.decided.inflation for t in result.ticks) > 0.01
    assert all(t.recorded.inflation == 0.0 for t in result.ticks)
    # Prediction from foreign commands would drift away; from the real ones it stays near.
    errors = [t.decided.prediction_error for t in result.ticks if t.decided.mode == "run"]
    assert max(errors) < 0.25


def test_what_is_readable_of_a_cut_file_is_used(recordings, tmp_path, capsys):
    whole = recordings["adaptive"].read_bytes()
    cut = tmp_path / "run.mcap"
    cut.write_bytes(whole[: len(whole) * 2 // 3])
    result = replay(tmp_path)
    assert not result.run.complete
    assert 50 < len(result.ticks) < len(read_run(recordings["adaptive"]).ticks)
    assert result.identical
    assert run_cli(["replay", str(cut)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert (
        f"cut off: {len(result.ticks)} whole ticks are readable of its {len(cut.read_bytes())} bytes" in said
    )


def test_side_by_side_as_csv_and_json(recordings, tmp_path, capsys):
    out = tmp_path / "ticks.csv"
    arguments = ["replay", str(recordings["adaptive"]), "--margin", "paper", "--out", str(out), "--json"]
    assert run_cli(arguments) == 0
    found = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert found["changed"]
    adaptive, paper = map(float, found["side_by_side"]["largest margin (m)"])
    assert adaptive > 0.0
    assert paper > 0.1
    with out.open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == found["ticks"]
    assert {"recorded_x [m/s]", "decided_x [m/s]"} <= set(rows[0])


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"robot.kind": "box"}, "has no influence"),
        ({"controller.period": 0.2}, "keeps the instants"),
        ({"controller.gamma": 3.0}, "controller.gamma"),
        ({"controllers": 3.0}, "has no influence"),
    ],
)
def test_settings_that_make_no_sense_are_refused(recordings, settings, line):
    with pytest.raises(InputError, match=line):
        replay(recordings["adaptive"], settings)


def rewritten(source: Path, path: Path, section: str, **changes) -> Path:
    """The recording, of a scenario that says something else in a section."""
    whole = read_run(source)
    scenario = whole.info.scenario | {section: whole.info.scenario.get(section, {}) | changes}
    written = RunFile(path, msgspec.structs.replace(whole.info, scenario=scenario))
    for tick in whole.ticks:
        written.tick(tick)
    written.close()
    return path


@pytest.mark.parametrize(
    ("section", "changes"),
    [
        ("robot", {"kind": "cart", "cart": {"wheels": 4}}),
        ("robot", {"cart": {"wheels": 4}}),
        ("steering", {"kind": "mouse", "mouse": {"speed": 1.0}}),
        ("margin", {"steady": {"mm": 3}}),
    ],
)
def test_kinds_that_are_not_replayed_need_not_be_installed(recordings, tmp_path, section, changes):
    assert replay(rewritten(recordings["adaptive"], tmp_path / "run.mcap", section, **changes)).identical


@pytest.mark.parametrize(
    ("section", "changes", "said"),
    [
        (
            "margin",
            {"kind": "steady", "steady": {"mm": 3}},
            "margin.kind: the margin law 'steady' .*farhand.margins",
        ),
        (
            "operator",
            {"predictor": "crystal"},
            "operator.predictor: the .* 'crystal' .*group farhand.predictors",
        ),
        (
            "controller",
            {"kind": "slow-near"},
            "controller.kind: the controller 'slow-near' .*farhand.controllers",
        ),
    ],
)
def test_a_kind_that_decided_is_named_with_its_group(recordings, tmp_path, section, changes, said):
    path = rewritten(recordings["adaptive"], tmp_path / "run.mcap", section, **changes)
    with pytest.raises(InputError, match=f"that decided is not installed|{said}") as found:
        replay(path)
    assert re.search(said, str(found.value))
    assert "install the package that brings it" in str(found.value)


def test_a_kind_that_is_replaced_is_not_needed(recordings, tmp_path):
    path = rewritten(recordings["adaptive"], tmp_path / "run.mcap", "margin", kind="steady", steady={"mm": 3})
    assert len(replay(path, {"margin.kind": "paper"}).ticks) > 140
    with pytest.raises(InputError, match=r"--set margin.kind 'papper': .*is 'paper' meant"):
        replay(path, {"margin.kind": "papper"})


@pytest.mark.parametrize("content", [b"", b"not a recording", b"\x89MCAP0\r\n"])
def test_files_that_hold_nothing_are_refused_in_one_line(tmp_path, content, capsys):
    path = tmp_path / "run.mcap"
    path.write_bytes(content)
    assert run_cli(["replay", str(path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert run_cli(["replay", str(tmp_path / "elsewhere")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_a_recording_with_a_gap_is_judged_up_to_it_and_says_so(recordings, tmp_path, capsys):
    """A disk that was full for a while: what came after the gap follows from ticks that are not there."""
    whole = read_run(recordings["adaptive"])
    file = ScriptedFile()
    written = RunFile(tmp_path / "unused", whole.info, file=file)
    file.fails = lambda number: 20 < number < 30
    for tick in whole.ticks:
        written.tick(tick)
    written.close()
    path = tmp_path / "run.mcap"
    path.write_bytes(file.read_bytes())
    result = replay(path)
    (gap,) = result.run.gaps
    assert not result.run.complete
    assert not result.run.cut_off
    assert len(result.judged) == gap.before < len(result.ticks)
    assert len(result.ticks) + gap.ticks == len(whole.ticks)
    assert result.identical
    assert result.unjudged == len(whole.ticks) - gap.before
    assert run_cli(["replay", str(path), "--margin", "paper"]) == 0  # compared, not judged
    capsys.readouterr()
    assert run_cli(["replay", str(path)]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert f"{gap.ticks} ticks are missing after tick {gap.before - 1}" in said
    assert "No space left on device" in said
    assert f"before the first gap all {gap.before} decisions are identical to the byte" in said
    assert "cannot be judged" in said


def test_replay_and_export_name_the_same_tick_before_each_of_two_gaps(tmp_path, capsys):
    """By the tick's own number: that of the second gap is not how many ticks are there before it."""
    make_run(tmp_path / "run.mcap", left_out=(*range(30, 34), *range(60, 65)))
    assert [gap.after for gap in read_run(tmp_path / "run.mcap").gaps] == [29, 59]
    for line in read_run(tmp_path / "run.mcap").flaws():
        assert "after tick 29, 2.9 s" in line or "after tick 59, 5.9 s" in line
    run_cli(["export", str(tmp_path / "run.mcap"), "--to", "csv", "--out", str(tmp_path / "out")])
    said = capsys.readouterr().err
    assert "4 ticks are missing after tick 29:" in said
    assert "5 ticks are missing after tick 59:" in said


def test_what_a_device_said_and_who_stopped_it_are_in_the_replay():
    steering = RecordedSteering()
    stopped = {"safety": "stopped", "safety_reason": "fault: it broke"}
    steering.report = report(mode="hold", stop_reason="robot stopped: fault: it broke; see to it", **stopped)
    assert steering.read(None).says == "see to it"
    steering.report = report(mode="hold", stop_reason="robot stopped: fault: it broke", **stopped)
    assert steering.read(None).says == ""
    steering.report = report(mode="estop", stop_reason="emergency stop by the operator")
    assert steering.read(None).estop
    steering.report = report(mode="estop", stop_reason=ESTOP_ASKED)
    assert not steering.read(None).estop  # the node is asked, as then
