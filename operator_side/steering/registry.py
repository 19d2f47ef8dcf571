"""The steering devices by name. A new one is one file and one line here, or an entry point of another package."""

from typing import TYPE_CHECKING

from farhand.common.kinds import Kinds, made
from farhand.common.scenario.section import own_settings
from farhand.operator_side.steering.settings import SteeringSettings

if TYPE_CHECKING:
    from farhand.operator_side.steering.device import SteeringDevice

DEVICES: "Kinds[type[SteeringDevice]]" = Kinds(
    "steering device",
    "farhand.devices",
    "farhand.operator_side.steering.device:SteeringDevice",
    {
        "tester": "farhand.operator_side.steering.tester.tester:Tester",
        "remote": "farhand.operator_side.steering.hand.remote:Remote",
        "gamepad": "farhand.operator_side.steering.hand.gamepad:Gamepad",
        "spacemouse": "farhand.operator_side.steering.hand.spacemouse:Spacemouse",
        "recorded": "farhand.operator_side.steering.recorded.recorded:Recorded",
        "person": "farhand.operator_side.steering.tester.person:Person",
        "hostile": "farhand.operator_side.steering.tester.hostile:Hostile",
        "paced": "farhand.operator_side.steering.tester.paced:Paced",
    },
)
BY_HAND = ("remote", "gamepad", "spacemouse")
"""Those of which a person is part: nobody steers them in virtual time."""


def make_device(settings: SteeringSettings) -> "SteeringDevice":
    """The device that the settings name; raises InputError."""
    device = DEVICES.get(settings.kind, "steering.kind")
    own = own_settings(settings, device, "steering")
    return made(f"steering device {settings.kind!r}", lambda: device(own))
