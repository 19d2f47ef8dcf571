"""The guard of spheres: no command stream brings one nearer than d_min, and none makes it add speed."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.geometry import Twist, norm, to_vector3
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.safety.guard.tool_guard import ToolGuard
from farhand.robot_side.scene.surroundings import surroundings_of

DT, RADIUS, D_MIN = 0.004, 0.1, 0.01
SCENE = (
    Obstacle(id="ball", position=(0.45, 0.1, 0.0), shape=Sphere(0.15)),
    Obstacle(
        id="crate", position=(-0.4, 0.1, 0.1), shape=Box((0.1, 0.4, 0.2)), orientation=(0.8, 0.6, 0.0, 0.0)
    ),
    Obstacle(
        id="rail", position=(0.0, -0.4, 0.2), shape=Capsule(0.05, 0.3), orientation=(0.6, 0.0, 0.8, 0.0)
    ),
    Obstacle(id="table", position=(0.0, 0.0, -0.35), shape=Plane()),
)
AROUND = surroundings_of(SCENE)
_speeds = st.floats(-2.0, 2.0)
_commands = st.lists(st.tuples(_speeds, _speeds, _speeds), min_size=1, max_size=8)
_off = st.sampled_from((-0.5, 0.0, 0.5))


def _clearance(position):
    return min(distance_to(each, to_vector3(position.tolist())) for each in SCENE) - RADIUS


def _drive(commands, lag, off, bound, bound_off, guarded=True):
    """Of a point that each command drives for 0.4 s: least clearance, and by how much it was told to speed up."""
    guard = ToolGuard(GuardSettings(d_min=D_MIN, acceleration=bound), RADIUS, lag, DT)
    x, v = np.zeros(3), np.zeros(3)
    share = 1.0 - math.exp(-DT / (lag * (1.0 + off)))
    most = bound * (1.0 + bound_off) * DT if bound else math.inf
    least, faster = 1e6, 0.0
    for command in commands:
        for _ in range(100):
            asked = done = Twist(command)
            if guarded:
                done = guard.allow(to_vector3(x.tolist()), to_vector3(v.tolist()), asked, AROUND)
            faster = max(faster, norm(done.linear) - max(norm(asked.linear), float(np.linalg.norm(v))))
            change = share * (np.array(done.linear) - v)
            length = float(np.linalg.norm(change))
            change *= min(1.0, most / length) if length else 1.0
            x = x + DT * (v + 0.5 * change)
            v = v + change
            least = min(least, _clearance(x))
    return least, faster


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    commands=_commands,
    lag=st.floats(0.03, 0.5),
    off=_off,
    bound=st.sampled_from((0.0, 1.0, 4.0)),
    bound_off=_off,
)
def test_no_commands_bring_it_too_near_and_none_make_it_faster(commands, lag, off, bound, bound_off):
    least, faster = _drive(commands, lag, off, bound, bound_off)
    assert least >= D_MIN
    assert faster <= 1e-9


@pytest.mark.parametrize("towards", [each.id for each in SCENE])
def test_without_it_the_same_commands_collide(towards):
    """So the test above can fail."""
    way = np.array(next(each.position for each in SCENE if each.id == towards))
    command = [to_vector3((way / np.linalg.norm(way)).tolist())] * 4
    assert _drive(command, 0.1, 0.0, 0.0, 0.0, guarded=False)[0] < 0.0
    assert _drive(command, 0.1, 0.0, 0.0, 0.0)[0] >= D_MIN


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    direction=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda d: norm(d) > 0.1),
    speed=st.floats(0.05, 0.5),
    asked=st.tuples(*[st.floats(-0.5, 0.5)] * 3),
    off=_off,
)
def test_it_steps_aside_from_what_comes(direction, speed, asked, off):
    """A ball that flies at it at constant velocity, whatever is asked meanwhile."""
    guard = ToolGuard(GuardSettings(d_min=D_MIN), RADIUS, 0.1, DT)
    unit = np.array(direction) / norm(direction)
    x, v, share = np.zeros(3), np.zeros(3), 1.0 - math.exp(-DT / (0.1 * (1.0 + off)))
    around = surroundings_of([Obstacle(id="ball", position=(0.0, 0.0, 0.0), shape=Sphere(0.1))])
    for tick in range(750):
        centre = unit * (0.6 - speed * tick * DT)
        around.move(0, centre.tolist(), (-speed * unit).tolist())
        assert np.linalg.norm(x - centre) - 0.1 - RADIUS >= D_MIN
        done = guard.allow(to_vector3(x.tolist()), to_vector3(v.tolist()), Twist(asked), around)
        change = share * (np.array(done.linear) - v)
        x, v = x + DT * (v + 0.5 * change), v + change


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("where", range(3))
def test_what_is_no_number_stands_still(bad, where):
    given = [[0.0, 0.0, 0.0] for _ in range(3)]
    given[where][where] = bad
    position, velocity, asked = (to_vector3(each) for each in given)
    guard = ToolGuard(GuardSettings(), RADIUS, 0.1, DT)
    assert guard.allow(position, velocity, Twist(asked), AROUND) == Twist()


def test_it_says_what_it_did_and_for_whose_sake():
    guard = ToolGuard(GuardSettings(), RADIUS, 0.1, DT)
    free = guard.allow((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), Twist((0.0, 0.0, 0.1)), AROUND)
    assert free == Twist((0.0, 0.0, 0.1))
    assert guard.did is None
    done = guard.allow((0.18, 0.1, 0.0), (0.0, 0.0, 0.0), Twist((1.0, 0.0, 0.0), (0.0, 0.0, 0.3)), AROUND)
    assert done.angular == (0.0, 0.0, 0.3)
    did = guard.did
    assert did is not None
    assert (did.part, did.obstacle, did.what) == ("tool", "ball", "slowed")
    assert did.distance == guard.nearest == pytest.approx(0.02)
    assert did.asked == pytest.approx(1.0)
    assert did.done == pytest.approx(5.0 * (0.02 - 0.012), rel=0.05)


def test_it_turns_where_that_way_is_free():
    guard = ToolGuard(GuardSettings(), RADIUS, 0.1, DT)
    done = guard.allow((0.188, 0.1, 0.0), (0.0, 0.0, 0.0), Twist((0.5, 0.0, 0.5)), AROUND)
    assert done.linear == pytest.approx((0.0, 0.0, 0.5), abs=1e-3)
    assert guard.did is not None
    assert guard.did.what == "turned"


def _least_between_balls(asked, seconds, speed):
    """Clearance of a point between two balls that a third comes along to, all in one plane (m)."""
    guard, scene = ToolGuard(GuardSettings(d_min=D_MIN), RADIUS, 0.1, DT), _between_balls()
    x, v, share, least = np.zeros(3), np.zeros(3), 1.0 - math.exp(-DT / 0.1), 1e6
    for tick in range(round(seconds / DT)):
        centre = (0.9 - speed * tick * DT, 0.0, 0.0)
        scene.move(2, centre, (-speed, 0.0, 0.0))
        gaps = [np.linalg.norm(x - row[1:4]) - row[13] - RADIUS for row in scene.rows]
        least = min(least, *gaps)
        done = guard.allow(to_vector3(x.tolist()), to_vector3(v.tolist()), Twist(asked), scene)
        change = share * (np.array(done.linear) - v)
        x, v = x + DT * (v + 0.5 * change), v + change
    return least, guard


def _between_balls():
    places = ((-0.25, 0.0, 0.22), (-0.25, 0.0, -0.22), (0.9, 0.0, 0.0))
    return surroundings_of(
        [Obstacle(id=f"ball-{i}", position=place, shape=Sphere(0.2)) for i, place in enumerate(places)]
    )


@pytest.mark.parametrize("speed", [0.1, 0.3, 0.5])
@pytest.mark.parametrize("asked", [(-0.5, 0.0, 0.0), (0.0, 0.0, 0.0)])
def test_what_comes_while_it_stands_in_a_corner_is_left_by_the_third_way(asked, speed):
    """No row points out of the plane: a guard that looks at them alone stays in the corner until it is hit."""
    least, guard = _least_between_balls(asked, 1.2 / speed, speed)
    assert least >= D_MIN
    assert guard.pinched == 0


def test_a_way_that_is_free_is_not_left():
    """What passes by changes nothing of what is asked."""
    guard = ToolGuard(GuardSettings(d_min=D_MIN), RADIUS, 0.1, DT)
    scene = surroundings_of(
        [Obstacle(id="mover", position=(0.9, 0.5, 0.0), velocity=(-0.3, 0.0, 0.0), shape=Sphere(0.2))]
    )
    asked = Twist((0.0, 0.0, 0.1))
    assert guard.allow((0.0, 0.0, 0.0), (0.0, 0.0, 0.1), asked, scene) == asked
    assert guard.did is None
