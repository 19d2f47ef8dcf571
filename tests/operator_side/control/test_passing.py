"""Which velocities pass: against the one-step filter, which solves for the nearest one."""

from dataclasses import replace

import numpy as np
import pytest

from farhand.common.seeds import stream
from farhand.operator_side.control.baselines.one_step import OneStep
from farhand.operator_side.control.passing import changes, in_the_way
from farhand.operator_side.control.settings import ControllerSettings
from farhand.testing import problem

SETTINGS = ControllerSettings(kind="one-step", speed_limit=(0.5, 0.5, 0.5))
WANTED = np.array([[0.4, 0.0, 0.0], [0.0, 0.4, 0.0], [-0.4, 0.0, 0.0]])


def test_a_sphere_ahead_lets_what_leads_past_it_and_away_from_it():
    ahead = problem(centres=[(0.26, 0.0, 0.0)], radii=[0.25])
    straight, across, back = changes(ahead, WANTED, SETTINGS)
    assert straight > 0.3
    assert across < 0.1
    assert back == 0.0
    assert [in_the_way(ahead, velocity, SETTINGS) for velocity in WANTED] == [0, -1, -1]


def test_a_plane_ahead_lets_what_goes_along_it():
    wall = replace(problem(centres=[(0.26, 0.0, 0.0)], radii=[0.25]), normals=np.array([[-1.0, 0.0, 0.0]]))
    straight, across, back = changes(wall, WANTED, SETTINGS)
    assert straight == pytest.approx(0.4 - 0.5 * 0.01 / 0.1)  # half of the centimetre may go in a step
    assert (across, back) == (0.0, 0.0)


def test_nothing_in_the_way_changes_nothing_but_what_is_beyond_the_limits():
    assert changes(problem(), WANTED, SETTINGS).tolist() == [0.0, 0.0, 0.0]
    assert changes(problem(), 2 * WANTED, SETTINGS) == pytest.approx([0.3, 0.3, 0.3])
    assert in_the_way(problem(), WANTED[0], SETTINGS) == -1


def test_between_walls_that_close_in_no_velocity_is_found():
    closing = problem(centres=[(0.3, 0.0, 0.0), (-0.3, 0.0, 0.0)], radii=[0.29, 0.29])
    closing = replace(closing, velocities=np.array([[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]))
    assert np.isinf(changes(closing, WANTED, SETTINGS)).all()


def test_the_change_is_that_of_the_nearest_velocity():
    draw, filtered = stream(3, "passing"), OneStep(SETTINGS)
    compared = 0
    for _ in range(200):
        n = int(draw.integers(1, 4))
        centres, radii = draw.uniform(-0.6, 0.6, (n, 3)), draw.uniform(0.1, 0.3, n)
        wanted = draw.uniform(-0.4, 0.4, 3)
        given = problem(desired=tuple(wanted), centres=centres, radii=radii)
        if np.min(np.linalg.norm(centres - given.position, axis=1) - radii) < 0.005:
            continue
        solved = filtered.solve(given)
        change = float(changes(given, wanted[None, :], SETTINGS)[0])
        assert change == pytest.approx(np.linalg.norm(solved.plan[0] - wanted), abs=0.05)
        compared += 1
    assert compared > 50
