"""What URDF and SRDF have in common: files of XML, numbers in attributes, joints' ends, roll, pitch and yaw."""

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array


def read_xml(path: Path, what: str) -> ET.Element:
    """The root of an XML file; raises InputError with `what` the file is as its first word."""
    try:
        return ET.parse(path).getroot()
    except OSError as error:
        raise InputError(f"{what} {path}: cannot be read: {error.strerror or error}") from None
    except (ET.ParseError, UnicodeError, ValueError) as error:
        raise InputError(f"{what} {path}: is not valid XML: {error}") from None


def numbers(element: ET.Element, key: str, default: Sequence[float] | None = None, *, size: int = 3) -> Array:
    """(size,) numbers of an attribute; raises InputError when they are none, or too many or few."""
    text = element.get(key)
    if text is None:
        if default is None:
            raise InputError(f"<{element.tag}>: {key} is missing")
        return np.array(default, dtype=float)
    try:
        found = np.array([float(word) for word in text.split()])
    except ValueError:
        found = np.array([math.nan])
    if len(found) != size or not np.isfinite(found).all():
        raise InputError(f"<{element.tag}>: {key}={text!r}: expected {size} finite number{'s' * (size > 1)}")
    return found


def ends(joint: ET.Element) -> tuple[str, str]:
    """The links that a joint holds together: parent and child."""
    parent, child = joint.find("parent"), joint.find("child")
    return (
        parent.get("link", "") if parent is not None else "",
        child.get("link", "") if child is not None else "",
    )


def rotation_rpy(rpy: Array) -> Array:
    """(3, 3) rotation of a URDF's roll, pitch and yaw (rad): about the fixed axes x, y, z in turn."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of_axis(axis: Array) -> Array:
    """(3,) roll, pitch and yaw (rad) of a frame whose z axis is the unit vector (3,)."""
    x, y, z = axis
    return np.array([0.0, np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)])
