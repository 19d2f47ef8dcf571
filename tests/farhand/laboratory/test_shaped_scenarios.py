"""The built-in scenarios with shapes: driven to the end and clear of all of them, also without the guard."""

import msgspec
import pytest

from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import moved
from farhand.laboratory.simulation import simulate
from farhand.runs.scenario import load_scenario, replace_settings
from tests.examples import also


@pytest.mark.parametrize(
    ("network", "guard"),
    [
        ("bursty-loss-20", True),
        ("outages", False),
        also("bursty-loss-20", False),
        also("outages", True),
    ],
)
@pytest.mark.parametrize(("name", "at_first", "least"), [("shuttle", "cart", 0.03), ("table", "crate", 0.03)])
def test_safe_over_bad_networks(name, at_first, least, network, guard):
    scenario = replace_settings(load_scenario(name), {"guard.on": guard})
    found = simulate(scenario, uplink=network, downlink=network, time_limit=60.0).summary
    assert found.safe
    assert found.finished
    assert found.nearest_obstacle == at_first
    assert found.min_clearance > least
    assert found.min_arm_clearance > least


def test_the_cart_is_in_the_way_of_the_arm():
    """Else the scenario would show nothing: the way that the tool takes where no cart is leads through it."""
    scenario = load_scenario("shuttle")
    (cart,) = scenario.obstacles
    alone = msgspec.structs.replace(scenario, obstacles=())
    found = simulate(alone, uplink="constant:50", downlink="constant:50", time_limit=60.0)
    gaps = [distance_to(moved(cart, t), (x, y, z)) for t, x, y, z, _ in found.trajectory]
    assert min(gaps) - scenario.robot.radius < -0.02
