"""Targets count for who drives there."""

from farhand.operator_side.steering.targets import Targets
from farhand.testing import scene, state

PLACES = ((1.0, 0.0, 0.0), (2.0, 0.0, 0.0))


def at(x, **fields):
    return state(1, position=(x, 0.0, 0.0), **fields)


def test_a_successor_has_targets_of_its_own_to_reach():
    """What the one before has reached, or passes while the successor waits, does not count."""
    targets, around = Targets(0.02), scene(0, targets=PLACES)
    for x in (1.0, 2.0):
        targets.update(at(x, holder=8), around, driving=False)
    assert (targets.reached, targets.next, targets.finished) == (0, PLACES[0], False)
    targets.update(at(2.0), around, driving=True)
    assert targets.reached == 0  # in order
    for x in (1.0, 2.0):
        targets.update(at(x), around, driving=True)
    assert targets.finished


def test_a_pause_of_control_loses_nothing_that_was_reached():
    targets, around = Targets(0.02), scene(0, targets=PLACES)
    targets.update(at(1.0), around, driving=True)
    targets.update(at(2.0), around, driving=False)
    assert (targets.reached, targets.next) == (1, PLACES[1])
