"""What a hand at another program wants, before it travels."""

from dataclasses import dataclass

from farhand.common.messages.base import ZERO, Quaternion, Vector3
from farhand.common.messages.steering import Frame, Unit


@dataclass(frozen=True, slots=True)
class Wish:
    """What the operator's program is told; see common/messages/steering.py."""

    engaged: bool = False
    press: int = 0
    linear: Vector3 = ZERO
    angular: Vector3 = ZERO
    unit: Unit = "share"
    frame: Frame = "base"
    view: Quaternion = (1.0, 0.0, 0.0, 0.0)
    scale: float = 1.0
    estop: bool = False
    acknowledge: bool = False
    take: bool = False
    release: bool = False
