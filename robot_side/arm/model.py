"""Where the UR5's description lies, and what PyBullet needs of it."""

import sys
import xml.etree.ElementTree as ET
from pathlib import Path

from farhand.common.errors import InputError

JOINTS = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
TOOL_FRAME = "tool0"
HOME = (-0.245, -1.63634, 1.97671, -1.91116, -1.5708, -0.245)  # rad; tool down at (0.45, 0, 0.30)
TORQUE_LIMITS = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)  # N m

_DATA = Path("cmeel.prefix/share/example-robot-data/robots")
_PACKAGE = "package://example-robot-data/robots/"


def data_folder() -> Path:
    """The folder of robot descriptions that the package example-robot-data brings; raises InputError."""
    for entry in sys.path:
        folder = Path(entry) / _DATA
        if folder.is_dir():
            return folder
    raise InputError("the UR5's description is missing: install the package example-robot-data")


def urdf_path() -> Path:
    """The UR5 with limited joints."""
    return data_folder() / "ur_description/urdf/ur5_joint_limited_robot.urdf"


def collision_urdf() -> str:
    """The URDF's text without visuals, which take a second to load, and with meshes by absolute path."""
    tree = ET.parse(urdf_path())
    for link in tree.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for mesh in tree.iter("mesh"):
        name = mesh.get("filename", "")
        mesh.set("filename", str(data_folder() / name.removeprefix(_PACKAGE)))
    return ET.tostring(tree.getroot(), encoding="unicode")


def never_colliding_pairs() -> set[frozenset[str]]:
    """Pairs of links whose contact means nothing, from the SRDF."""
    srdf = data_folder() / "ur_description/srdf/ur5_joint_limited_robot.srdf"
    pairs = ET.parse(srdf).iter("disable_collisions")
    return {frozenset((pair.get("link1", ""), pair.get("link2", ""))) for pair in pairs}
