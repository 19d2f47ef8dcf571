"""What a hand feels: the share of what is asked that is not done."""

import pytest

from farhand.common.messages.intervention import Intervention
from farhand.operator_side.devices.resistance import resistance
from farhand.testing import report

GUARD = Intervention(
    part="forearm", obstacle="ball", distance=0.03, limit=0.01, asked=0.2, done=0.05, what="slowed"
)


@pytest.mark.parametrize(
    ("fields", "share"),
    [
        ({"desired": (0.2, 0.0, 0.0), "filtered": (0.2, 0.0, 0.0)}, 0.0),
        ({"desired": (0.2, 0.0, 0.0), "filtered": (0.195, 0.0, 0.0)}, 0.0),
        ({"desired": (0.2, 0.0, 0.0), "filtered": (0.1, 0.0, 0.0)}, 0.5),
        ({"desired": (0.2, 0.0, 0.0), "filtered": (0.2, 0.2, 0.0)}, 1.0),
        ({"desired": (0.2, 0.0, 0.0), "filtered": (-0.5, 0.0, 0.0)}, 1.0),
        ({"desired_angular": (0.0, 0.0, 0.4), "angular": (0.0, 0.0, 0.3)}, 0.25),
        ({"desired": (0.2, 0.0, 0.0), "filtered": (0.2, 0.0, 0.0), "guard": GUARD}, 0.75),
        ({"desired": (0.0, 0.0, 0.0), "filtered": (0.1, 0.0, 0.0)}, 0.0),
    ],
)
def test_share_of_what_is_not_done(fields, share):
    zero = {"desired": (0.0, 0.0, 0.0), "filtered": (0.0, 0.0, 0.0)}
    assert resistance(report(**zero | fields)) == pytest.approx(share)
