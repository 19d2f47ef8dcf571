"""What a folder holds is what its page shows: of all commands, and of a table that was stopped."""

import json
import re

import msgspec
import pytest

from farhand.common.errors import InputError
from farhand.laboratory.campaigns.tasks import make_task
from farhand.runs.scenario import scenario_to_table
from farhand.trials.leaderboard import running
from farhand.trials.leaderboard.choice import chosen_board
from farhand.trials.leaderboard.plan.board import command_of
from farhand.trials.leaderboard.plan.rows import Row, lost, row_of
from farhand.trials.leaderboard.run_board import run_board
from farhand.trials.leaderboard.tasks import posing
from farhand.trials.leaderboard.tasks.posing import Posed
from tests.farhand.trials.leaderboard.test_board import HerePool, rows_in

TASK = scenario_to_table(make_task(0, 0))


def posed(job):
    return Posed(key=job.key, scene=job.scene, index=job.index, seed=job.seed, duration=9.0, scenario=TASK)


def ran(spec):
    return msgspec.structs.replace(
        row_of(spec),
        safe=True,
        success=True,
        finished=True,
        duration=10.0,
        ideal_duration=9.0,
        min_clearance=0.02,
    )


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(posing, "pose", posed)
    monkeypatch.setattr(running, "run_one", ran)
    monkeypatch.setattr("farhand.trials.leaderboard.telling.files.draw_figures", lambda rows, folder: [])
    monkeypatch.setattr("farhand.trials.leaderboard.run_board.CHUNK", 1)


def board(methods="nothing", **more):
    asked = {"tasks": 2, "networks": ["constant"], "scenes": "static", "operators": "tester", **more}
    return chosen_board(methods=methods, **asked)


def page_of(folder):
    text = (folder / "index.html").read_text()
    return json.loads(re.search(r"const BOARD = (\{.*\});\n", text).group(1).replace("<\\/", "</"))


def test_what_is_added_to_a_folder_is_shown_with_what_was_there(tmp_path, capsys):
    out = tmp_path / "table"
    assert run_board(board("paper,nothing"), HerePool(), out) == 0
    assert run_board(board("guard", networks=["none"]), HerePool(), out) == 0
    assert "4 of these 6 runs are of other commands in" in " ".join(capsys.readouterr().out.split())
    shown = page_of(out)
    assert (shown["methods"], shown["networks"], shown["tasks"]) == (
        ["nothing", "paper", "guard"], ["none", "constant"], 2
    )  # fmt: skip
    assert shown["cells"]["tester|paper|static|constant"]["n"] == 2
    assert "tester|paper|static|none" not in shown["cells"]
    assert len((out / "tasks.csv").read_text().splitlines()) == 1 + 6
    text = (out / "index.html").read_text()
    kept = json.loads((out / "campaign.json").read_text())["selection"]["commands"]
    assert [re.search(r"--methods (\S+)", each).group(1) for each in kept] == ["paper,nothing", "guard"]
    for command in kept:
        assert command in text
        assert command in (out / "leaderboard.md").read_text()


def test_one_task_alone_leaves_the_table_as_it_is(tmp_path):
    out = tmp_path / "table"
    assert run_board(board(tasks=3), HerePool(), out) == 0
    assert run_board(board(tasks=None, only=1), HerePool(), out) == 0
    shown = page_of(out)
    assert (shown["tasks"], shown["only"], shown["cells"]["tester|nothing|static|constant"]["n"]) == (
        3,
        None,
        3,
    )
    alone = tmp_path / "alone"
    assert run_board(board(tasks=None, only=1), HerePool(), alone) == 0
    assert page_of(alone)["only"] == 1


def test_a_table_that_is_stopped_has_its_page(tmp_path, monkeypatch, capsys):
    out, done = tmp_path / "table", []

    def interrupted(spec):
        if len(done) == 2:
            raise KeyboardInterrupt
        done.append(spec)
        return ran(spec)

    monkeypatch.setattr(running, "run_one", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_board(board("nothing,guard"), HerePool(), out)
    said = " ".join(capsys.readouterr().out.split())
    assert "interrupted: 2 of 4 runs are kept in" in said
    assert page_of(out)["cells"]["tester|guard|static|constant"]["n"] == 1
    assert (out / "leaderboard.md").exists()


def test_a_table_that_is_stopped_while_tasks_are_posed_goes_on_in_its_own_folder(
    tmp_path, monkeypatch, capsys
):
    def interrupted(job):
        raise KeyboardInterrupt

    monkeypatch.setattr(posing, "pose", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_board(board(), HerePool(), tmp_path / "table")
    said = "".join(capsys.readouterr().out.split())
    assert f"0of2tasksarekeptin{tmp_path}/table/tasks;thesamewith--out{tmp_path}/tablegoeson" in said


def test_a_crash_is_run_again_and_a_task_that_could_not_be_posed_is_said(tmp_path, monkeypatch, capsys):
    out = tmp_path / "table"
    monkeypatch.setattr(running, "run_one", lambda spec: lost(spec, "no memory") if spec.index else ran(spec))
    assert run_board(board(), HerePool(), out) == 1
    monkeypatch.setattr(running, "run_one", ran)
    assert run_board(board(), HerePool(), out) == 0
    assert "1 of 2 runs are there already" in capsys.readouterr().out

    def half(job):
        return posing.lost(job, "none could be done") if job.index else posed(job)

    monkeypatch.setattr(posing, "pose", half)
    other = tmp_path / "other"
    assert run_board(board(), HerePool(), other) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "tasks that could not be posed, and are in no cell: static/1: none could be done" in said


def test_what_another_command_crashed_is_shown_as_it_was(tmp_path, monkeypatch):
    out = tmp_path / "table"
    monkeypatch.setattr(running, "run_one", lambda spec: lost(spec, "no memory") if spec.index else ran(spec))
    assert run_board(board("paper"), HerePool(), out) == 1
    monkeypatch.setattr(running, "run_one", ran)
    assert run_board(board("both"), HerePool(), out) == 0
    cell = page_of(out)["cells"]["tester|paper|static|constant"]
    assert (cell["n"], cell["crashed"], cell["safeOf"]) == (2, 1, 1)


def test_versions_of_a_method_do_not_meet_in_a_cell(tmp_path, monkeypatch):
    out, code = tmp_path / "table", ["one"]
    monkeypatch.setattr(
        "farhand.trials.leaderboard.plan.board.code_of", lambda name: code[0] * (name == "guard")
    )
    assert run_board(board("guard,nothing", tasks=4), HerePool(), out) == 0
    code[0] = "two"
    assert run_board(board("guard"), HerePool(), out) == 0
    cells = page_of(out)["cells"]
    assert cells["tester|guard|static|constant"]["n"] == 2
    assert cells["tester|nothing|static|constant"]["n"] == 4


def test_a_table_of_another_version_that_is_stopped_before_its_first_run_ends_as_it_should(
    tmp_path, monkeypatch
):
    out, code = tmp_path / "table", ["one"]
    monkeypatch.setattr("farhand.trials.leaderboard.plan.board.code_of", lambda name: code[0])
    assert run_board(board("guard"), HerePool(), out) == 0

    def interrupted(spec):
        raise KeyboardInterrupt

    monkeypatch.setattr(running, "run_one", interrupted)
    code[0] = "two"
    with pytest.raises(KeyboardInterrupt):
        run_board(board("guard"), HerePool(), out)


def test_cells_are_in_the_json(tmp_path, capsys):
    assert run_board(board(), HerePool(), tmp_path / "table", as_json=True) == 0
    (cell,) = json.loads(capsys.readouterr().out)["cells"]
    assert (cell["method"], cell["network"], cell["runs"], cell["safe"]) == ("nothing", "constant", 2, 2)


def test_a_folder_that_is_no_tables_and_a_damaged_row_are_refused(tmp_path):
    foreign = tmp_path / "site"
    foreign.mkdir()
    (foreign / "index.html").write_text("mine")
    with pytest.raises(
        InputError, match=r"holds index.html, which would be written anew, and no campaign.json"
    ):
        run_board(board(), HerePool(), foreign)
    assert (foreign / "index.html").read_text() == "mine"

    out = tmp_path / "table"
    assert run_board(board(), HerePool(), out) == 0
    whole = (out / "rows.jsonl").read_text()
    first, second = whole.splitlines(keepends=True)
    (out / "rows.jsonl").write_text(first[:30] + "\n" + second)
    with pytest.raises(InputError, match=r"rows.jsonl, line 1: is no row"):
        run_board(board(), HerePool(), out)
    assert second in (out / "rows.jsonl").read_text()  # nothing is lost
    (out / "rows.jsonl").write_text(first + second[:30])
    assert run_board(board(), HerePool(), out) == 0
    assert [row["index"] for row in rows_in(out)] == [0, 1]


def test_the_command_of_a_row_names_it():
    row = Row(key="k", network="constant", scene="static", method="guard", operator="tester", index=4, seed=2)
    assert command_of(row, 7).endswith("--scenes static --methods guard --operators tester --task 4 --seed 7")
