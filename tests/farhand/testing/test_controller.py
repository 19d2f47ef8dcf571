import numpy as np
import pytest

from farhand.operator_side.control.controller import ControlSolution, Status
from farhand.operator_side.control.settings import ControllerSettings
from farhand.testing import ScriptedController, problem


def test_a_velocity_is_held_over_the_horizon():
    controller = ScriptedController((0.1, 0.0, 0.2), settings=ControllerSettings(horizon=4))
    solution = controller.solve(problem())
    assert solution.plan.tolist() == [[0.1, 0.0, 0.2]] * 4
    assert solution.status is Status.OPTIMAL


def test_a_plan_and_a_status_are_given_as_they_are():
    plan = np.arange(30.0).reshape(10, 3)
    controller = ScriptedController(plan, Status.ELASTIC)
    solution = controller.solve(problem())
    assert np.array_equal(solution.plan, plan)
    solution.plan[:] = 9.0  # the node's array is its own
    assert np.array_equal(controller.solve(problem()).plan, plan)
    assert solution.status is Status.ELASTIC


def test_an_answer_can_depend_on_the_problem():
    controller = ScriptedController(lambda given: given.desired / 2)
    assert controller.solve(problem(desired=(0.4, 0.0, 0.0))).plan[0] == pytest.approx((0.2, 0.0, 0.0))
    whole = ControlSolution(np.zeros((10, 3)), Status.FAILED, iterations=3)
    controller.answer = lambda given: whole
    assert controller.solve(problem()) is whole


def test_it_counts_and_keeps():
    controller, asked = ScriptedController(), problem(position=(1.0, 2.0, 3.0))
    controller.prepare()
    controller.solve(asked)
    controller.reset()
    controller.reset()
    assert (controller.prepared, controller.resets) == (1, 2)
    assert controller.problems[0] is asked


def test_a_problem_has_arrays_of_the_right_shape():
    given = problem(centres=[(1, 0, 0), (2, 0, 0)], radii=[1, 2], sigma=(0.1, 0.2))
    shapes = [each.shape for each in (given.position, given.desired, given.centres, given.radii)]
    assert shapes == [(3,), (3,), (2, 3), (2,)]
    assert (given.velocities.tolist(), given.sigmas.tolist()) == ([[0.0] * 3] * 2, [0.1, 0.2])
    assert problem().centres.shape == problem().velocities.shape == (0, 3)
    assert problem(radii=[0.1], centres=[(1, 0, 0)], sigma=0.5).sigmas.tolist() == [0.5]
    with pytest.raises(ValueError, match="reshape"):
        problem(centres=[(1, 0, 0)], radii=[1, 2])
