"""The leaderboard: a row is the same by its command, after an interruption, and beside a method of one's own."""

import importlib.metadata
import json
import re
import shlex
import sys
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from types import SimpleNamespace

import msgspec
import pytest

from farhand.cli import run
from farhand.laboratory.campaigns import pools
from farhand.laboratory.campaigns.tasks import make_task
from farhand.trials.leaderboard import running
from farhand.trials.leaderboard.choice import chosen_board
from farhand.trials.leaderboard.methods.method import METHODS, method_named
from farhand.trials.leaderboard.plan.board import Board, command_of
from farhand.trials.leaderboard.plan.networks import NETWORKS
from farhand.trials.leaderboard.run_board import run_board
from farhand.trials.leaderboard.telling.tables import percent
from tests.installed import ROOT

PAGE = (ROOT / "docs" / "leaderboard.md").read_text(encoding="utf-8")


class Here(Executor):
    """Does it at once, in this process."""

    def submit(self, fn, /, *args, **kwargs):
        done = Future()
        try:
            done.set_result(fn(*args, **kwargs))
        except KeyboardInterrupt:
            raise
        except Exception as error:
            done.set_exception(error)
        return done


class HerePool(pools.Pool):
    width = 0.5  # one chunk is handed in after the other

    def __init__(self, workers=1):
        super().__init__(1)

    @contextmanager
    def open(self, workers=0):
        yield Here()


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch, tmp_path):
    monkeypatch.setattr(pools, "LocalPool", HerePool)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")


def small(**more):
    return chosen_board(
        tasks=1, networks=["constant"], scenes="passage", methods="nothing,guard", operators="tester", **more
    )


def rows_in(folder):
    return [json.loads(line) for line in (folder / "rows.jsonl").read_text().splitlines()]


@pytest.mark.long
def test_a_row_is_the_same_by_its_command_and_after_an_interruption(tmp_path, monkeypatch, capsys):
    whole, halves = tmp_path / "whole", tmp_path / "halves"
    assert run_board(small(), HerePool(), whole) == 0
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= 80
    nothing, guard = rows_in(whole)
    assert (nothing["safe"], guard["success"]) == (False, True)
    assert nothing["violation_depth"] > 0.01
    assert nothing["min_clearance"] < 0.0 < 0.01 <= guard["min_clearance"]
    assert 0.5 < nothing["duration"] / nothing["ideal_duration"] < 1.0  # late, it brakes late

    monkeypatch.setattr("farhand.trials.leaderboard.telling.files.draw_figures", lambda rows, folder: [])
    command = command_of(SimpleNamespace(**guard), seed=1)
    assert run([*shlex.split(command)[1:], "--out", str(tmp_path / "again")]) == 0
    assert rows_in(tmp_path / "again") == [guard]

    done = []

    def interrupted(spec):
        if done:
            raise KeyboardInterrupt
        done.append(spec)
        return running.witnessed(spec)

    monkeypatch.setattr("farhand.trials.leaderboard.run_board.CHUNK", 1)
    with monkeypatch.context() as patched:
        patched.setattr(running, "run_one", interrupted)
        with pytest.raises(KeyboardInterrupt):
            run_board(small(), HerePool(), halves)
    assert rows_in(halves) == [nothing]
    assert run_board(small(), HerePool(), halves) == 0
    assert (halves / "tasks.csv").read_bytes() == (whole / "tasks.csv").read_bytes()
    assert (halves / "tasks.parquet").read_bytes() == (whole / "tasks.parquet").read_bytes()
    page = (whole / "index.html").read_text()
    assert not re.search(r'(?:src|href)="(?!data:)', page)
    assert '"tester|guard|passage|constant":{"n":1' in page


@pytest.mark.slow
def test_a_method_of_ones_own_appears_in_the_same_table(tmp_path, monkeypatch):
    name, text = re.search(r"^`([\w.]+)`:\n\n```python\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE).groups()
    (tmp_path / name).write_text(text)
    command = re.search(r"^farhand (benchmark .*way_margin:Way.*)$", PAGE, re.MULTILINE).group(1)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    command = command.replace("--methods nothing,ours,", "--methods nothing,").replace(
        "--tasks 2", "--tasks 1"
    )
    assert run(shlex.split(command)) == 0
    theirs, own = rows_in(tmp_path / "runs" / "way")
    assert (theirs["method"], theirs["safe"]) == ("nothing", False)
    assert (own["method"], own["safe"], own["error"]) == ("way_margin:Way", True, "")
    assert own["seed"] == theirs["seed"]
    assert "@" in own["key"]  # of this version of the file
    table = (tmp_path / "runs" / "way" / "leaderboard.md").read_text()
    assert "| tester | nothing | 1 |" in table
    assert "| tester | way_margin:Way | 1 |" in table
    assert "| nothing | static | 1 | 0 | 100.00 | 1 |" in table
    assert "| way_margin:Way | constant | 1 | 1 | 97.50 | 0 |" in table


def test_a_package_brings_a_method(monkeypatch):
    point = importlib.metadata.EntryPoint(
        "theirs", "farhand.trials.leaderboard.methods.built_in:Nothing", "farhand.methods"
    )
    monkeypatch.setattr(
        "importlib.metadata.entry_points", lambda group: [point] if group == "farhand.methods" else []
    )
    monkeypatch.setattr(METHODS, "_outside", None)  # it looks for them once
    monkeypatch.setattr(METHODS, "_loaded", {})
    board = chosen_board(methods="theirs,both", networks=["none"], tasks=1)
    assert board.methods == ("theirs", "both")
    assert method_named("theirs").says == method_named("nothing").says
    assert chosen_board(networks=["none"], tasks=1).methods[-1] == "theirs"


@pytest.mark.parametrize(
    ("option", "value", "says"),
    [
        ("--networks", "constent", "must be some of none, gaussian"),
        ("--networks", "loss:nonsense", "at character"),
        ("--scenes", "moon", "must be some of static, clutter"),
        ("--methods", "oars", "must be some of nothing, paper"),
        ("--methods", "nowhere:Method", "cannot be imported"),
        ("--methods", "json:JSONDecoder", "is no subclass of farhand.Method"),
        ("--operators", ",", "names none of tester"),
        ("--task=1 --tasks", "2", "leave one out"),
        ("--tasks", "0", "greater than or equal to 1"),
    ],
)
def test_bad_input_is_one_line(option, value, says, capsys):
    assert run(["benchmark", "safety", *option.split(), value]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert len(said.splitlines()) == 1


def test_who_slows_down_has_a_margin_for_the_way_of_a_round_trip():
    scenario = make_task(0, 0)
    settings = method_named("speed-scaling").settings_for(scenario)
    margin, paced = settings["margin.worst-case"], settings["steering.paced"]
    longest = paced["full_until"] + scenario.controller.period + scenario.robot.lag
    assert margin["delay"] == pytest.approx(longest)
    assert margin["speed"] == max(scenario.controller.speed_limit)
    assert paced["device"] == scenario.steering.kind


def test_cells_advance_together_and_arms_have_fewer_tasks():
    board = Board(tasks=10, scenes=("static", "ur5"), operators=("tester", "hostile"))
    assert [len(board.tasks_of(s, o)) for s in board.scenes for o in board.operators] == [10, 2, 2, 1]
    jobs = board.pose_jobs()
    assert len(jobs) == len({job.key for job in jobs}) == 12
    assert {job.key for job in jobs[:8]} >= {"static/0", "ur5/0", "static/4"}
    assert set(NETWORKS) >= {
        "none",
        "loss-40",
        "bursty-loss-40",
        "outages-0.5s",
        "outages-5s",
        "oran",
        "jump",
    }


def test_a_rate_is_only_whole_where_all_are():
    assert [percent(share) for share in (None, 1.0, 0.9996, 0.0, 0.0001, 0.5)] == [
        "–", "100", "99.9", "0", "0.1", "50"
    ]  # fmt: skip


def test_rows_are_typed():
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert({"key": 3}, running.Row)
