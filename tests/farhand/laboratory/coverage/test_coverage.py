"""Margins held against what became of each command."""

import json
from pathlib import Path

import pytest

from farhand import cli
from farhand.laboratory.coverage.campaign import Drive, drive
from farhand.laboratory.coverage.measures import coverage_of
from farhand.laboratory.coverage.observer import Chosen
from farhand.laboratory.coverage.traces import find_traces
from farhand.runs.run import COMPUTING_TIME


def driven(spec, law, seconds=10.0):
    _, predictor, commands = drive(Drive(spec, spec, law, seconds))
    return predictor, coverage_of(commands)


def chosen(width=0.1, reckoned=None, error=None, answered=None):
    return Chosen(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), width, reckoned, error, answered)


def test_what_never_took_effect_has_no_error_and_what_was_never_answered_was_not_in_time():
    found = coverage_of(
        [
            chosen(error=0.05, reckoned=0.2, answered=0.2),
            chosen(error=0.15, reckoned=0.2, answered=0.3),
            chosen(reckoned=0.2),
            chosen(answered=0.4),
        ]
    )
    assert (found.commands, found.applied, found.within) == (4, 2, 0.5)
    assert found.answered_within == pytest.approx(1 / 3)
    assert (found.answered_mean, found.answered_most) == (pytest.approx(0.3), 0.4)


def test_without_commands_there_is_nothing_to_say():
    found = coverage_of([])
    assert found.commands == 0
    assert found.within is found.answered_within is found.width_mean is None


def test_over_a_constant_delay_the_round_trip_is_known_and_the_timeline_right():
    predictor, paper = driven("constant:100", "paper")
    assert predictor == "history"
    assert paper.answered_mean == pytest.approx(0.2 + COMPUTING_TIME, abs=1e-3)
    assert paper.answered_within > 0.9
    predictor, own = driven("constant:100", "adaptive")
    assert predictor == "timeline"
    assert own.within == 1.0
    assert own.error_95 < 1e-3
    assert own.answered_within is None


def test_who_knows_what_is_unanswered_is_surprised_by_an_outage_less_often():
    spec = "constant:20 outage:every(5s,2s)"
    _, paper = driven(spec, "paper", 20.0)
    _, watchful = driven(spec, "watchful", 20.0)
    assert watchful.answered_within > paper.answered_within + 0.05
    assert watchful.reckoned_mean > paper.reckoned_mean


WORDS = ["margin", "coverage", "--laws", "paper,adaptive", "--seconds", "5", "--workers", "1"]


def said(words, capsys):
    assert cli.run([*WORDS, *words]) == 0
    return capsys.readouterr()


def recording(path):
    path.parent.mkdir(exist_ok=True)
    path.write_text("# unit: ms\n# period: 10 ms\n" + "20\n" * 60)
    return str(path)


def test_the_table_fits_a_terminal_and_says_each_network_once(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    network = "uniform:50,200 loss:gilbert(30%,30%)"
    text = said(["--network", network, "--network", "constant:20"], capsys).out
    assert max(len(line) for line in text.splitlines()) <= 80
    assert text.count("constant:20") == 1
    (row, *_) = [line.split() for line in text.splitlines() if line.startswith("paper")]
    found = driven(network, "paper", 5.0)[1]
    assert found.applied < found.commands
    assert row[1] == f"{found.applied}/{found.commands}"
    assert row[3] == f"{1000 * found.error_95:.0f}/{1000 * found.error_most:.0f}"
    assert len(row) == 8  # in one line: no row became a list, and no cell is cut


def test_a_file_gets_the_table_and_nothing_else(capsys, monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    found = said(["--network", "constant:20"], capsys)
    assert found.out.startswith("margins")
    assert found.err == ""


def test_the_rows_as_json(capsys):
    rows = json.loads(said(["--network", "constant:20", "--json"], capsys).out)
    assert [(row["network"], row["law"], row["predictor"]) for row in rows] == [
        ("constant:20", "paper", "history"),
        ("constant:20", "adaptive", "timeline"),
    ]


def test_recordings_of_one_name_are_told_apart_by_their_folders(tmp_path):
    files = [recording(tmp_path / name) for name in ("ta/d.csv", "tb/d.csv", "tb/e.csv")]
    again = str(tmp_path / "tb" / ".." / "ta" / "d.csv")
    found, left_out = find_traces([Path(file) for file in (*files, again, str(tmp_path))])
    assert list(found) == ["ta/d.csv", "tb/d.csv", "e.csv"]
    assert [Path(spec.split('"')[1]).resolve() for spec in found.values()] == [Path(file) for file in files]
    assert left_out == []


def test_however_many_foreign_files_a_folder_holds_they_are_one_line(tmp_path, capsys):
    recording(tmp_path / "d.csv")
    for number in range(3):
        (tmp_path / f"foreign-{number}.md").write_text("words\n")
    found = said(["--trace", str(tmp_path)], capsys)
    lines = [line for line in found.err.splitlines() if "left out" in line]
    assert len(lines) == 1
    assert "3 files" in lines[0]
    assert "foreign-0.md" in lines[0]
    assert "foreign-1" not in found.err


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ([], "give --trace"),
        (["--network", "constant:20", "--laws", "watchfull"], "watchful"),
        (["--network", "constant:x"], "constant"),
        (["--trace", "EMPTY"], "no file in it"),
    ],
)
def test_bad_input_is_one_line(words, why, tmp_path, capsys):
    words = [str(tmp_path) if word == "EMPTY" else word for word in words]
    assert cli.run(["margin", "coverage", *words]) == 2
    err = capsys.readouterr().err.strip()
    assert why in err
    assert "\n" not in err
