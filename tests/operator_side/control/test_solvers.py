"""Every controller: bad input, edge cases, honest statuses; and the choice between them."""

import builtins
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from msgspec import structs

from benchmarks.solver_instances import random_problems
from farhand.common.errors import InputError
from farhand.common.seeds import stream
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import ControlProblem, Status
from farhand.operator_side.control.ipopt import IpoptController
from farhand.operator_side.control.newton import NewtonController
from farhand.operator_side.control.registry import SOLVERS, make_controller
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.sqp import SLOTS, SqpController
from farhand.testing import problem as make_problem
from tests.examples import also

SETTINGS = ControllerSettings()
ROOT = Path(__file__).resolve().parents[3]
ALL = [
    pytest.param(
        structs.replace(SETTINGS, kind=kind, solver=solver, wall_time_limit=0.3), id=f"{kind}-{solver}"
    )
    for kind, solver in [
        ("mpc-cbf", "newton"),
        ("mpc-cbf", "sqp"),
        ("mpc-cbf", "ipopt"),
        ("mpc-distance", "newton"),
        ("one-step", "newton"),
        ("pass-through", "newton"),
    ]
]
MPC = ALL[:4]


scene = partial(make_problem, sigma=0.002)
AHEAD = scene(centres=[(0.25, 0.01, 0.0)], radii=[0.15])


def assert_sound(solution, settings):
    assert solution.plan.shape == (settings.horizon, 3)
    assert np.all(np.isfinite(solution.plan))
    assert np.all(np.abs(solution.plan) <= np.array(settings.speed_limit) + 1e-12)


@pytest.mark.parametrize("settings", ALL)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e30])
@pytest.mark.parametrize("field", ["position", "desired", "centres", "radii", "velocities", "sigmas"])
def test_a_number_that_is_not_finite_is_refused(settings, field, bad):
    controller = make_controller(settings)
    problem = scene(centres=[(0.4, 0, 0)], radii=[0.1])
    getattr(problem, field).flat[0] = bad
    solution = controller.solve(problem)
    assert solution.status is Status.BAD_INPUT
    assert not solution.plan.any()
    assert controller.solve(AHEAD).status is not Status.BAD_INPUT  # and it is over with the next tick


@pytest.mark.parametrize("settings", ALL)
def test_wrong_shapes_and_a_negative_radius_are_refused(settings):
    controller = make_controller(settings)
    for problem in (
        ControlProblem(np.zeros(2), np.zeros(3), np.zeros((1, 3)), np.ones(1), np.zeros((1, 3)), np.zeros(1)),
        ControlProblem(np.zeros(3), np.zeros(3), np.zeros(3), np.ones(1), np.zeros((1, 3)), np.zeros(1)),
        ControlProblem(np.zeros(3), np.zeros(3), np.zeros((2, 3)), np.ones(1), np.zeros((1, 3)), np.zeros(1)),
        ControlProblem(np.zeros(3), np.zeros(3), np.zeros((1, 3)), np.ones(1), np.zeros((1, 3)), np.zeros(2)),
        ControlProblem(None, np.zeros(3), np.zeros((1, 3)), np.ones(1), np.zeros((1, 3)), np.zeros(1)),
        scene(centres=[(1, 0, 0)], radii=[-0.1]),
    ):
        assert controller.solve(problem).status is Status.BAD_INPUT


EDGES = {
    "no obstacle": scene(),
    "coincident": scene(centres=[(0.25, 0.01, 0)] * 3, radii=[0.15] * 3),
    "inside": scene(centres=[(0.05, 0.01, 0)], radii=[0.15]),
    "at the very centre": scene(centres=[(0, 0, 0)], radii=[0.15]),
    "between two": scene(centres=[(0.15, 0, 0), (-0.15, 0, 0)], radii=[0.149, 0.149]),
    "sigma above h": scene(centres=[(0.25, 0.01, 0)], radii=[0.15], sigma=0.5),
    "sigma far above h": scene(centres=[(0.25, 0.01, 0)], radii=[0.15], sigma=50.0),
    "collinear": scene(centres=[(0.25, 0, 0)], radii=[0.15]),
    "outside the box": scene(desired=(3.0, -2.0, 0.1), centres=[(0.25, 0.01, 0)], radii=[0.15]),
    "outside the box, free": scene(desired=(3.0, -2.0, 0.1)),
    "on the surface": scene(centres=[(0.15, 0, 0)], radii=[0.15], sigma=0.0),
    "radius zero": scene(centres=[(0.05, 0, 0)], radii=[0.0]),
    "approaching": scene(centres=[(0.3, 0.01, 0)], radii=[0.15], velocities=[(-0.3, 0, 0)]),
    "standing": scene(desired=(0, 0, 0), centres=[(0.25, 0.01, 0)], radii=[0.15]),
    "walled in": scene(
        centres=0.25 * np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]),
        radii=[0.2] * 6,
    ),
}


HARD = {"inside", "at the very centre", "between two", "sigma above h", "sigma far above h", "radius zero"}
"""Where a status that is not good is an honest answer."""


@pytest.mark.parametrize("settings", ALL)
@pytest.mark.parametrize("name", EDGES)
def test_edge_cases_give_a_sound_plan_and_an_honest_status(settings, name):
    controller = make_controller(settings)
    for _ in range(3):  # cold, then warm
        solution = controller.solve(EDGES[name])
        assert_sound(solution, settings)
        assert solution.status.good or name in HARD or settings.kind == "pass-through"
        if settings.kind != "one-step" and solution.status.good:
            effective = getattr(controller, "settings", settings)
            violation, _ = rows.worst_violation(EDGES[name], solution.plan, effective)
            assert violation <= 2 * rows.ROW_TOLERANCE
        if settings.solver == "newton":
            assert solution.iterations <= 2 * settings.max_iterations


@pytest.mark.parametrize("settings", MPC)
def test_one_step_that_cannot_recover_is_proven_infeasible(settings):
    assert make_controller(settings).solve(EDGES["sigma far above h"]).status is Status.INFEASIBLE


@pytest.mark.parametrize("settings", [also(*p.values) if "ipopt" in str(p.id) else p for p in ALL])
def test_500_obstacles(settings):
    rng = stream(3, "solvers", "many")
    away = rng.normal(size=(500, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    radii = rng.uniform(0.05, 0.1, 500)
    problem = scene(centres=away * (radii + rng.uniform(0.08, 1.0, 500))[:, None], radii=radii)
    solution = make_controller(settings).solve(problem)
    assert_sound(solution, settings)
    assert solution.status.good or settings.solver != "newton" or settings.kind == "pass-through"
    if solution.status.good and settings.kind == "mpc-cbf":
        assert rows.worst_violation(problem, solution.plan, settings)[0] <= 2 * rows.ROW_TOLERANCE


@pytest.mark.parametrize("settings", MPC[:3])
def test_the_binding_obstacle_is_named(settings):
    far = scene(centres=[(3, 0, 0), (0.25, 0.01, 0.0), (0, 4, 0)], radii=[0.1, 0.15, 0.1])
    assert make_controller(settings).solve(far).binding == 1


def test_the_number_of_obstacles_may_change_from_tick_to_tick():
    controller = make_controller(SETTINGS)
    for count in (1, 40, 0, 3, 200, 2):
        centres = [(0.25 + 0.02 * k, 0.01, 0) for k in range(count)]
        assert_sound(controller.solve(scene(centres=centres, radii=[0.15] * count)), SETTINGS)


def test_inputs_are_left_alone_and_any_memory_layout_does():
    problem = scene(centres=[(0.25, 0.01, 0.0), (0.3, 0.3, 0.0)], radii=[0.15, 0.1])
    before = [np.copy(getattr(problem, name)) for name in ("position", "desired", "centres", "radii")]
    first = NewtonController(SETTINGS).solve(problem)
    strange = ControlProblem(
        problem.position.astype(np.float32).astype(float)[::-1][::-1],
        problem.desired,
        np.asfortranarray(problem.centres),
        problem.radii,
        problem.velocities,
        problem.sigmas,
    )
    for array in (strange.centres, strange.radii, strange.position):
        array.flags.writeable = False
    second = NewtonController(SETTINGS).solve(strange)
    assert first.plan.tobytes() == second.plan.tobytes()
    after = [getattr(problem, name) for name in ("position", "desired", "centres", "radii")]
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))


def test_a_plan_once_given_does_not_change_with_the_next_tick():
    controller = NewtonController(SETTINGS)
    plan = controller.solve(AHEAD).plan
    kept = plan.copy()
    controller.solve(scene(desired=(-0.2, 0.1, 0.0), centres=[(-0.2, 0.01, 0)], radii=[0.12]))
    assert np.array_equal(plan, kept)


def test_reset_forgets_the_warm_start():
    controller = NewtonController(SETTINGS)
    first = controller.solve(AHEAD)
    controller.solve(scene(desired=(0.1, 0.2, 0), centres=[(0.2, 0.05, 0)], radii=[0.15]))
    controller.reset()
    assert controller.solve(AHEAD).plan.tobytes() == first.plan.tobytes()


@pytest.mark.parametrize("horizon", [1, 2, 10, 40])
@pytest.mark.parametrize("period", [0.1, 0.02, 0.01])
def test_any_horizon_and_rate_drives_round_an_obstacle(horizon, period):
    settings = structs.replace(SETTINGS, horizon=horizon, period=period, speed_limit=(0.3, 0.25, 0.2))
    controller = NewtonController(settings)
    position = np.zeros(3)
    target = np.array([0.6, 0.0, 0.0])
    for _ in range(round(5 / period)):
        away = target - position
        if np.linalg.norm(away) < 0.02:
            break
        problem = scene(position, 0.2 * away / np.linalg.norm(away), [(0.3, 0.03, 0.01)], [0.1], 0.0005)
        solution = controller.solve(problem)
        assert_sound(solution, settings)
        assert solution.status.good
        position = position + period * solution.plan[0]
        assert np.linalg.norm(position - problem.centres[0]) >= 0.1
    assert np.linalg.norm(target - position) < 0.02


def test_the_sqp_judges_against_obstacles_that_had_no_slot():
    count = SLOTS[-1] + 20
    centres = [(0.25 + 1e-4 * k, 0.01, 0) for k in range(count)]
    problem = scene(centres=centres, radii=[0.15] * count)
    solution = SqpController(SETTINGS).solve(problem)
    assert_sound(solution, SETTINGS)
    assert solution.status.good
    assert rows.worst_violation(problem, solution.plan, SETTINGS)[0] <= rows.ROW_TOLERANCE


def test_ipopt_stops_at_its_time_limit():
    settings = structs.replace(SETTINGS, wall_time_limit=1e-4)
    solution = IpoptController(settings).solve(AHEAD)
    assert solution.status is Status.CAPPED
    assert_sound(solution, settings)


def test_pass_through_clips_and_says_that_a_row_is_violated():
    settings = structs.replace(SETTINGS, kind="pass-through")
    controller = make_controller(settings)
    solution = controller.solve(scene(desired=(0.9, -0.1, 0)))
    assert solution.status is Status.SHORTCUT
    assert np.array_equal(solution.plan, np.tile([0.3, -0.1, 0.0], (10, 1)))
    blocked = controller.solve(scene(centres=[(0.3, 0.0, 0)], radii=[0.2]))
    assert blocked.status is Status.ELASTIC
    assert blocked.violation > 0


def test_one_step_keeps_the_decay_and_is_no_filter_when_free():
    controller = make_controller(structs.replace(SETTINGS, kind="one-step"))
    assert np.allclose(controller.solve(scene()).plan[0], (0.25, 0, 0))
    position = np.zeros(3)
    h = 0.25**2 + 0.01**2 - 0.15**2
    for _ in range(30):
        solution = controller.solve(scene(position, centres=[(0.25, 0.01, 0)], radii=[0.15]))
        assert solution.status is Status.OPTIMAL
        position = position + SETTINGS.period * solution.plan[0]
        h_next = float(np.sum((position - (0.25, 0.01, 0)) ** 2) - 0.15**2)
        assert h_next - 0.002 >= (1 - SETTINGS.gamma) * h - 1e-9
        h = h_next


def test_mpc_distance_goes_nearer_than_the_barrier():
    near = {}
    for kind in ("mpc-cbf", "mpc-distance"):
        controller = make_controller(structs.replace(SETTINGS, kind=kind))
        position = np.zeros(3)
        near[kind] = np.inf
        for _ in range(40):
            position = (
                position
                + 0.1
                * controller.solve(scene(position, centres=[(0.4, 0.01, 0)], radii=[0.15], sigma=0.002)).plan[
                    0
                ]
            )
            near[kind] = min(near[kind], float(np.sum((position - (0.4, 0.01, 0)) ** 2) - 0.15**2))
    assert 0.002 - 1e-5 <= near["mpc-distance"] < near["mpc-cbf"]


def test_unknown_names_are_refused_in_one_line():
    for change in ({"kind": "magic"}, {"solver": "magic"}):
        with pytest.raises(InputError, match="'magic': no such") as error:
            make_controller(structs.replace(SETTINGS, **change))
        assert "\n" not in str(error.value)


def test_without_numba_the_sqp_takes_over_and_says_so(monkeypatch):
    real = builtins.__import__

    def without_numba(name, *arguments, **options):
        if name == "numba" or name.startswith("numba."):
            raise ImportError("no numba here")
        return real(name, *arguments, **options)

    for module in [
        m
        for m in sys.modules
        if m == "numba" or m.startswith(("numba.", "farhand.operator_side.control.newton"))
    ]:
        monkeypatch.delitem(sys.modules, module)
    import farhand.operator_side.control as package

    for name in ("newton", "newton_kernel"):
        monkeypatch.delattr(package, name, raising=False)
    monkeypatch.setattr(builtins, "__import__", without_numba)
    monkeypatch.setattr(SOLVERS, "_loaded", {})
    controller = make_controller(SETTINGS)
    assert isinstance(controller, SqpController)
    assert "no numba here" in controller.solver_notice
    assert "\n" not in controller.solver_notice
    assert controller.solve(scene(centres=[(0.25, 0.03, 0.0)], radii=[0.15])).status.good


def test_choosing_imports_no_solver_that_is_not_chosen():
    code = (
        "import sys\n"
        "from farhand.operator_side.control.settings import ControllerSettings as S\n"
        "from farhand.operator_side.control.registry import SOLVERS, make_controller\n"
        "assert not {'numba', 'casadi', 'daqp'} & set(sys.modules)\n"
        "make_controller(S())\n"
        "assert not {'casadi', 'daqp'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60, cwd=ROOT)


def test_where_a_later_constraint_cannot_be_met_it_says_elastic():
    """The first step could keep the margin, but the obstacle is too fast for the horizon."""
    chased = scene(desired=(0.05, 0, 0), centres=[(0.8, 0.02, 0.01)], radii=[0.2], velocities=[(-2.6, 0, 0)])
    assert not rows.cannot_recover(chased, SETTINGS)
    solution = NewtonController(SETTINGS).solve(chased)
    assert solution.status is Status.ELASTIC
    assert solution.violation > rows.ROW_TOLERANCE
    assert_sound(solution, SETTINGS)


def test_a_pinch_is_never_called_good():
    """Each obstacle alone could be left in one step; between the two there is no room."""
    pinch = scene(centres=[(0.15, 0, 0), (-0.15, 0, 0)], radii=[0.149, 0.149], sigma=0.0025)
    for index in range(2):
        assert not rows.cannot_recover(rows.subset(pinch, np.array([index])), SETTINGS)
    solution = NewtonController(SETTINGS).solve(pinch)
    assert not solution.status.good
    assert_sound(solution, SETTINGS)


def test_a_second_start_finds_what_the_first_did_not():
    problem = list(random_problems(9))[8]
    solution = NewtonController(SETTINGS).solve(problem)
    assert solution.iterations > SETTINGS.max_iterations
    assert solution.status is Status.OPTIMAL


def test_from_inside_the_old_plan_through_the_obstacle_is_not_followed():
    controller = NewtonController(SETTINGS)
    controller.solve(scene((-0.16, 0, 0), (0.3, 0, 0), [(0.9, 0.01, 0)], [0.1]))
    inside = scene((-0.13, 0.0, 0.0), (0.3, 0.0, 0.0), [(0.0, 0.01, 0.0)], [0.15])
    solution = controller.solve(inside)
    assert (inside.position - inside.centres[0]) @ solution.plan[0] > 0


def test_a_change_in_number_forgets_what_belonged_to_other_obstacles():
    controller = NewtonController(SETTINGS)
    controller.solve(AHEAD)
    two = scene(centres=[(0.0, 0.3, 0.01), (0.25, 0.01, 0.0)], radii=[0.2, 0.15])
    assert controller.solve(two).plan.tobytes() == NewtonController(SETTINGS).solve(two).plan.tobytes()
