"""Those who steer like people: late, trembling, slower over bad networks, or to do harm."""

import math

import numpy as np
import pytest

from farhand.common.messages.base import Echo
from farhand.common.messages.scene import Obstacle
from farhand.operator_side.steering.device import View
from farhand.operator_side.steering.targets import Targets
from farhand.operator_side.steering.tester.hostile import Hostile, HostileSettings
from farhand.operator_side.steering.tester.paced import Paced, PacedSettings
from farhand.operator_side.steering.tester.person import Person, PersonSettings
from farhand.testing import messages

TICK_NS = 100_000_000


def view(tick, position=(0.0, 0.0, 0.0), targets=((2.0, 0.0, 0.0),), obstacles=(), rtt=None):
    now_ns = (tick + 100) * TICK_NS
    echo = None
    if rtt is not None:
        echo = Echo(session=7, seq=1, t_sent_ns=now_ns - round(rtt * 1e9), hold_ns=0)
    state = messages.state(mode="run", holder=7, holder_name="me", position=position, echo=echo)
    scene = messages.scene(targets=targets, obstacles=obstacles)
    progress = Targets(0.02)
    progress.update(state, scene)
    return View(state, scene, progress, now_ns)


def speeds(person, ticks, **given):
    return [person.read(view(tick, **given)).velocity[0] for tick in range(ticks)]


def test_a_person_reacts_after_the_reaction_time_and_trembles_by_the_seed():
    first, again = speeds(Person(PersonSettings(seed=3)), 30), speeds(Person(PersonSettings(seed=3)), 30)
    assert first[:3] == [0.0, 0.0, 0.0]  # 0, 100 and 200 ms after what is seen
    assert first[3] > 0.1
    assert first == again
    assert first != speeds(Person(PersonSettings(seed=4)), 30)
    late = first[10:]
    assert 0.01 < np.std(late) < 0.2
    assert np.mean(late) == pytest.approx(0.5, abs=0.1)


def swing(delay, gain=2.5):
    """How far a person overshoots a target 1 m away, as a share, where the robot shows up so late (s)."""
    person, positions = Person(PersonSettings(noise=0.0, crossover=gain)), [0.0]
    late = round(delay / 0.1)
    for tick in range(150):
        seen = positions[max(0, len(positions) - 1 - late)]
        asked = person.read(view(tick, (seen, 0.0, 0.0), ((1.0, 0.0, 0.0),), rtt=delay))
        positions.append(positions[-1] + 0.1 * asked.velocity[0])
        if abs(seen - 1.0) < 0.02 and tick > 100:
            break
    return max(positions) - 1.0


def test_a_person_overshoots_more_the_later_the_robot_shows():
    assert swing(0.0) < swing(0.4) < 0.5


def test_an_enemy_steers_at_what_is_nearest_and_ends():
    near = Obstacle(id="near", position=(0.0, 0.0, 1.0), radius=0.2)
    enemy = Hostile(HostileSettings(seed=1, speed=0.4, duration=3.0))
    for tick in range(31):
        asked = enemy.read(view(tick, obstacles=(near,)))
        assert asked.engaged
        assert asked.velocity == pytest.approx((0.0, 0.0, 0.4), abs=1e-6)
    assert enemy.over


def test_who_is_paced_is_slower_by_the_round_trip():
    paced = Paced(PacedSettings(full_until=0.1, slowest=0.05))
    for rtt, share in ((None, 1.0), (0.05, 1.0), (0.1, 1.0), (0.4, 0.25), (9.0, 0.05)):
        asked = paced.read(view(0, rtt=rtt)).velocity
        assert math.hypot(*asked) == pytest.approx(0.5 * share)
