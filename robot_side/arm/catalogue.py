"""The arms that are known by name: those of the package example-robot-data that have been tried."""

import difflib
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from farhand.common.errors import InputError

_DATA = Path("cmeel.prefix/share/example-robot-data/robots")
_CAPSULES = Path(__file__).resolve().parent / "models"


@dataclass(frozen=True, slots=True)
class KnownArm:
    """What is known of an arm beside its URDF.

    Attributes:
        title: for people.
        urdf, srdf: files under `data_folder()`.
        tool_frame: link of the URDF.
        home: tool down, roomy (rad).
        max_acceleration: of the joints (rad/s^2): the manufacturer's, or one for all.
        elbow, wrist: indices of the joints at whose zero the arm is stretched, the wrist singular; -1: none.
        reach: where the tool, pointing down, finds room; for people.
        holds_itself: whether its controller compensates gravity. Where none does, light links behind heavy ones
            creep in the simulation, whose solver ends before it has found the motors' torques.
    """

    title: str
    urdf: str
    srdf: str
    tool_frame: str
    home: tuple[float, ...]
    max_acceleration: tuple[float, ...]
    elbow: int
    wrist: int
    reach: str
    holds_itself: bool


def _universal(size: int, home: tuple[float, ...], reach: str) -> KnownArm:
    """The three arms of one family; their links have the same names, so that one SRDF serves them all."""
    return KnownArm(
        title=f"UR{size}",
        urdf=f"ur_description/urdf/ur{size}_joint_limited_robot.urdf",
        srdf="ur_description/srdf/ur5_joint_limited_robot.srdf",
        tool_frame="tool0",
        home=home,
        max_acceleration=(15.0,) * 6,
        elbow=2,
        wrist=4,
        reach=reach,
        holds_itself=False,
    )


ARMS = {
    "ur3": _universal(
        3,
        (-0.42916, -1.65642, 2.21355, -2.12792, -1.5708, -0.42916),  # tool at (0.27, 0, 0.20)
        "it reaches 0.15 to 0.4 m from its axis, 0.1 to 0.4 m high",
    ),
    "ur5": _universal(
        5,
        (-0.245, -1.63634, 1.97671, -1.91116, -1.5708, -0.245),  # tool at (0.45, 0, 0.30)
        "it reaches 0.27 to 0.7 m from its axis, 0.1 to 0.6 m high",
    ),
    "ur10": _universal(
        10,
        (-0.2364, -1.49271, 1.93555, -2.01363, -1.5708, -0.2364),  # tool at (0.70, 0, 0.40)
        "it reaches 0.35 to 1.0 m from its axis, 0.1 to 0.8 m high",
    ),
    "panda": KnownArm(
        title="Panda",
        urdf="panda_description/urdf/panda.urdf",
        srdf="panda_description/srdf/panda.srdf",
        tool_frame="panda_hand_tcp",
        home=(0.0, -0.31102, 0.0, -2.34742, 0.0, 2.03641, 0.7854),  # tool at (0.45, 0, 0.35)
        max_acceleration=(15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
        elbow=-1,  # offset: it is stretched nowhere near its zero
        wrist=5,
        reach="it reaches 0.3 to 0.6 m from its axis, 0.1 to 0.6 m high",
        holds_itself=True,
    ),
}


def data_folder() -> Path:
    """The folder of robot descriptions that the package example-robot-data brings; raises InputError."""
    for entry in sys.path:
        folder = Path(entry) / _DATA
        if folder.is_dir():
            return folder
    raise InputError("the arms' descriptions are missing: install the package example-robot-data")


def capsule_path(name: str) -> Path:
    """Where the capsules of a known arm lie."""
    return _CAPSULES / f"{name}.toml"


def nearest(name: str, known: Iterable[str]) -> str:
    """What may have been meant: the nearest names, or all."""
    known = sorted(known)
    close = difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    return f"nearest are {', '.join(close)}" if close else f"there are {', '.join(known[:12])}"
