"""The arms that are known by name: those of the package example-robot-data that have been tried, and two whose shapes
another package has."""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

from farhand.common.errors import InputError
from farhand.robot_side.arm.description.finding import installed, nearest

_DATA = Path("cmeel.prefix/share/example-robot-data/robots")
_MODELS = Path(__file__).resolve().parent / "models"


@dataclass(frozen=True, slots=True)
class KnownArm:
    """What is known of an arm beside its URDF.

    Attributes:
        title: for people.
        urdf, srdf: files under `data_folder()`; with `shapes`, in the folder of models.
        tool_frame: link of the URDF.
        home: tool down, roomy (rad).
        max_acceleration: of the joints (rad/s^2): the manufacturer's, or one for all.
        elbow, wrist: indices of the joints at whose zero the arm is stretched, the wrist singular; -1: none.
        reach: where the tool, pointing down, finds room; for people.
        holds_itself: whether its controller compensates gravity. Where none does, light links behind heavy ones
            creep in the simulation, whose solver ends before it has found the motors' torques.
        shapes: Python package that has its meshes; empty: example-robot-data.
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
    shapes: str = ""


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


def _universal_e(size: int, home: tuple[float, ...], reach: str) -> KnownArm:
    """Of the e-Series: by its published link lengths, with the meshes of the package airo-models."""
    return replace(
        _universal(size, home, reach),
        title=f"UR{size}e",
        urdf=f"ur{size}e.urdf",
        srdf="ur_e_series.srdf",
        shapes="airo_models",
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
    "ur3e": _universal_e(
        3,
        (-0.50678, -1.72479, 2.21521, -2.06122, -1.5708, -0.50678),  # tool at (0.27, 0, 0.20)
        "it reaches 0.15 to 0.4 m from its axis, 0.1 to 0.4 m high",
    ),
    "ur5e": _universal_e(
        5,
        (-0.30073, -1.60442, 2.10334, -2.06971, -1.5708, -0.30073),  # tool at (0.45, 0, 0.30)
        "it reaches 0.27 to 0.7 m from its axis, 0.1 to 0.6 m high",
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


SHAPELESS = ("ur7e", "ur8long", "ur10e", "ur12e", "ur15", "ur16e", "ur18", "ur20", "ur30")
"""UR arms of which no package that is known here has the shapes: without these nothing keeps them clear."""


def unknown_arm(name: str) -> str:
    """What is said of a name that is no known arm's."""
    if name.lower() in SHAPELESS:
        return "its shape is not known here: give its urdf, with meshes for contact (docs/ur.md)"
    return f"no such arm; {nearest(name, ARMS)}"


def urdf_of(known: KnownArm) -> Path:
    """The file; raises InputError where the package with its shapes is missing."""
    if not known.shapes:
        return data_folder() / known.urdf
    if installed(known.shapes) is None:
        raise InputError(
            f"the shapes of the {known.title} are missing: install farhand[ur-e], or the package "
            f"{known.shapes.replace('_', '-')}"
        )
    return _MODELS / known.urdf


def srdf_of(known: KnownArm) -> Path:
    """The file; raises InputError where the package with it is missing."""
    return (_MODELS if known.shapes else data_folder()) / known.srdf


def data_folder() -> Path:
    """The folder of robot descriptions that the package example-robot-data brings; raises InputError."""
    for entry in sys.path:
        folder = Path(entry) / _DATA
        if folder.is_dir():
            return folder
    raise InputError("the arms' descriptions are missing: install the package example-robot-data")


def capsule_path(name: str) -> Path:
    """Where the capsules of a known arm lie."""
    return _MODELS / f"{name}.toml"
