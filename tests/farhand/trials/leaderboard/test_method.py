"""A method may change what is its own, and nothing of the task; its kinds are there while it runs, and no other's."""

import sys
from contextlib import suppress

import pytest

from farhand import Margin, MarginLaw, Method
from farhand.common.errors import InputError
from farhand.laboratory.campaigns.tasks import make_task
from farhand.operator_side.margins.registry import MARGINS
from farhand.runs.scenario import scenario_to_table
from farhand.trials.leaderboard import running
from farhand.trials.leaderboard.methods.code import code_of
from farhand.trials.leaderboard.methods.method import applied
from farhand.trials.leaderboard.plan.board import Board
from farhand.trials.leaderboard.plan.networks import NETWORKS, check_content, content_of
from farhand.trials.leaderboard.plan.operators import OPERATORS
from farhand.trials.leaderboard.plan.rows import row_of
from farhand.trials.leaderboard.tasks.posing import Posed
from farhand.trials.leaderboard.telling.cells import cell_of
from farhand.trials.leaderboard.wall_limit import wall_limit

TASK = make_task(0, 0)


def method(**settings):
    return type("Mine", (Method,), {"settings": settings})()


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"obstacles": []}, "obstacles"),
        ({"targets": [[0.6, 0.0, 0.6]]}, "targets"),
        ({"start": [0.5, 0.0, 0.6]}, "start"),
        ({"robot.radius": 0.05}, "robot.radius"),
        ({"safety.stop_timeout": 9.0, "safety.lease_timeout": 9.5}, "safety."),
        ({"network.uplink": "none"}, "network"),
        ({"controller.d_min": 0.002}, "controller.d_min"),
        ({"controller.d_min": 0.03}, "controller.d_min"),
        ({"operator.tolerance": 0.5}, "operator.tolerance"),
        ({"operator.rate_hz": 100.0}, "operator.rate_hz"),
        ({"steering.kind": "tester"}, "steering.kind"),
        ({"steering.kind": "paced", "steering.paced": {"device": "tester"}}, "steering.kind"),
        (
            {"steering.kind": "person", "steering.person": {"device": "hostile", "settings": {"seed": 3}}},
            "steering",
        ),
        ({"controller.period": 0.05}, "controller.period"),
    ],
)
def test_what_is_the_tasks_no_method_changes(settings, says):
    hostile = OPERATORS["hostile"].applied_to(TASK, 3)
    with pytest.raises(InputError, match=says):
        applied(method(**settings), hostile)


@pytest.mark.parametrize(
    "settings",
    [
        {"controller.gamma": 0.2, "controller.kind": "one-step", "controller.speed_limit": [0.1, 0.1, 0.1]},
        {
            "margin.kind": "paper",
            "operator.predictor": "history",
            "operator.resync_after": 0.5,
            "guard.on": False,
        },
        {"steering.kind": "paced", "steering.paced": {"device": "hostile", "settings": {"seed": 3}}},
    ],
)
def test_what_is_its_own_a_method_changes(settings):
    hostile = OPERATORS["hostile"].applied_to(TASK, 3)
    changed = applied(method(**settings), hostile)
    assert changed != hostile
    assert changed.targets == hostile.targets


def test_nobody_is_faster_than_the_task_lets_them():
    limits = {"controller.speed_limit": [1.9, 0.1, 1.9], "controller.angular_limit": 1.9}
    found = applied(method(**limits), TASK).controller
    x, _, z = TASK.controller.speed_limit
    assert found.speed_limit == (x, 0.1, z)
    assert found.angular_limit == TASK.controller.angular_limit


class Wide(MarginLaw):
    """Half a metre."""

    def evaluate(self, given):
        return Margin(inflation=0.5)


def test_a_kind_is_there_while_its_method_runs_and_no_longer():
    brings = type("Brings", (Method,), {"settings": {"margin.kind": "wide"}, "margins": {"wide": Wide}})()
    with brings.known():
        assert applied(brings, TASK).margin.kind == "wide"
    assert "wide" not in MARGINS
    with pytest.raises(InputError, match="wide"):
        applied(method(**{"margin.kind": "wide"}), TASK)


def test_what_a_script_has_added_is_there_again_after_a_method_of_the_same_name(monkeypatch):
    monkeypatch.setattr(MARGINS, "_loaded", dict(MARGINS._loaded))
    monkeypatch.setattr(MARGINS, "_added", set())
    other = type("Other", (Wide,), {})
    MARGINS.add("wide", other)
    with type("Brings", (Method,), {"margins": {"wide": Wide}})().known():
        assert MARGINS.get("wide") is Wide
    assert MARGINS.get("wide") is other
    with type("Same", (Method,), {"margins": {"wide": other}})().known():
        assert MARGINS.get("wide") is other
    assert MARGINS.get("wide") is other


def write_method(folder, monkeypatch, name, law):
    (folder / f"{name}_law.py").write_text(
        "from farhand import Margin, MarginLaw\n\n\nclass Law(MarginLaw):\n"
        f"    def evaluate(self, given):\n        {law}\n"
    )
    (folder / f"{name}.py").write_text(
        f"from farhand import Method\nfrom {name}_law import Law\n\n\nclass Mine(Method):\n"
        f"    margins = {{'{name}': Law}}\n    settings = {{'margin.kind': '{name}', 'guard.on': False}}\n"
    )
    monkeypatch.setattr(sys, "path", [str(folder), *sys.path])
    return f"{name}:Mine"


def spec_of(name):
    posed = Posed(key="static/0", scene="static", index=0, seed=1, duration=20.0, path_length=5.0,
                  scenario=scenario_to_table(TASK))  # fmt: skip
    (spec,) = Board(tasks=1, networks={"none": "none"}, scenes=("static",), methods=(name,),
                    operators=("tester",)).specs([posed])  # fmt: skip
    return spec


def test_a_method_that_raises_is_neither_safe_nor_done(tmp_path, monkeypatch):
    name = write_method(tmp_path, monkeypatch, "raises_in_a_tick", "raise RuntimeError('boom')")
    row = running.run_one(spec_of(name))
    assert "boom" in row.error
    cell = cell_of([row, row_of(spec_of(name))])
    assert (cell.runs, cell.crashed, cell.safe, cell.successes) == (2, 1, 0, 0)


def test_a_method_that_hangs_costs_its_row_alone(tmp_path, monkeypatch):
    monkeypatch.setattr(running, "LONGEST", 0.3)
    name = write_method(tmp_path, monkeypatch, "hangs_in_a_tick", "import time; time.sleep(60.0)")
    assert "took more than 0.3 s of real time" in running.run_one(spec_of(name)).error


def swallowing():
    """Work that takes the end of its time, twice, for somebody's error."""
    with wall_limit(0.05):
        for _ in range(2):
            with suppress(TimeoutError):
                while True:
                    pass


def test_what_swallows_the_end_of_its_time_is_late_all_the_same(monkeypatch):
    monkeypatch.setattr("farhand.trials.leaderboard.wall_limit.AGAIN", 0.05)
    with pytest.raises(TimeoutError, match="took more than"):
        swallowing()
    with wall_limit(5.0):
        pass


def test_rows_are_keyed_by_all_the_files_of_a_method_and_of_a_network(tmp_path, monkeypatch):
    name = write_method(tmp_path, monkeypatch, "has_a_law_beside", "return Margin(inflation=0.1)")
    spec = spec_of(name)
    before = code_of(name)
    assert f"/{name}@{before}/" in spec.key
    code_of.cache_clear()
    law = tmp_path / "has_a_law_beside_law.py"
    law.write_text(law.read_text().replace("0.1", "0.2"))
    assert code_of(name) != before
    assert "has changed since the table was begun" in running.run_one(spec).error

    trace = tmp_path / "trace.csv"
    trace.write_text("t_ms,delay_ms\n0,10\n100,20\n")
    text = f"trace:{trace}"
    first = content_of(text, text)
    trace.write_text("t_ms,delay_ms\n0,10\n100,30\n")
    assert first
    content_of.cache_clear()
    assert content_of(text, text) not in ("", first)
    with pytest.raises(InputError, match="have changed since the table was begun"):
        check_content(text, text, f"{text}@{first}/static/nothing/tester/0")
    assert content_of("constant", NETWORKS["constant"]) == ""
