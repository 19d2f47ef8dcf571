"""Margins held against what became of each command."""

import json

import pytest

from farhand import cli
from farhand.laboratory.coverage.campaign import Drive, drive
from farhand.laboratory.coverage.measures import coverage_of
from farhand.laboratory.coverage.observer import Chosen
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


def test_the_table_and_its_json(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    words = [
        "margin",
        "coverage",
        "--network",
        "constant:20",
        "--laws",
        "paper",
        "--seconds",
        "5",
        "--workers",
        "1",
    ]
    assert cli.run(words) == 0
    assert "constant:20" in capsys.readouterr().out
    assert cli.run([*words, "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert (row["network"], row["law"], row["predictor"]) == ("constant:20", "paper", "history")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "give --trace"),
        (["--network", "constant:20", "--laws", "watchfull"], "watchful"),
        (["--network", "constant:x"], "constant"),
        (["--trace", "EMPTY"], "no file in it"),
    ],
)
def test_bad_input_is_one_line(words, said, tmp_path, capsys):
    words = [str(tmp_path) if word == "EMPTY" else word for word in words]
    assert cli.run(["margin", "coverage", *words]) == 2
    err = capsys.readouterr().err.strip()
    assert said in err
    assert "\n" not in err
