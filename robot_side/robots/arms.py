"""The arm that a scenario's robot is: known by name or read from files, with what it holds."""

import dataclasses
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from farhand.common.errors import InputError, ScenarioError
from farhand.common.geometry import Array
from farhand.common.seeds import stream
from farhand.robot_side.arm.capsules import read_capsules
from farhand.robot_side.arm.catalogue import ARMS, unknown_arm
from farhand.robot_side.arm.description.srdf import Semantics, read_srdf
from farhand.robot_side.arm.description.urdf import Chain, read_urdf, tool_frame_of
from farhand.robot_side.arm.model import ArmModel, assemble, model, read_known
from farhand.robot_side.arm.tool import with_tool
from farhand.robot_side.robots.settings import RobotSettings, ToolSettings, wrong_length

if TYPE_CHECKING:
    from farhand.robot_side.arm.fitting.arm import FittedArm

FIT_SEED = 1
"""Of the configurations in which overlaps of fitted capsules are counted."""


def chosen_arm(settings: RobotSettings) -> ArmModel:
    """The model, with its tool, its accelerations within `robot.max_joint_acceleration`.

    Raises ScenarioError when a file cannot be used, or what is said of the arm does not fit it; the key is named.
    """
    try:
        arm = _named(settings) if settings.known_model else _from_settings(settings)
    except InputError as error:
        raise ScenarioError(f"robot: {error}") from None
    if settings.joints is not None and len(settings.joints) != arm.n:
        raise ScenarioError("robot: " + wrong_length("joints", len(settings.joints), arm.title, arm.n))
    if settings.tool is not None:
        arm = _holding(arm, settings.tool)
    most = np.minimum(arm.max_acceleration, settings.max_joint_acceleration)
    return dataclasses.replace(arm, max_acceleration=most)


def model_from_files(
    urdf: Path,
    srdf: Path | None = None,
    capsules: Path | None = None,
    tool_frame: str = "",
    home: Sequence[float] | None = None,
) -> ArmModel:
    """Any arm by its files.

    Args:
        urdf: six or seven revolute joints in a row, with limits.
        srdf: says which links never collide; without it: those that a joint holds together.
        capsules: what was fitted; without it they are fitted now, which takes seconds.
        tool_frame: link; empty: the SRDF's end effector.
        home: (n,) rad; without it the SRDF's first named configuration of these joints.

    Raises InputError in one line that names the file.
    """
    chain, frame, semantics = read_arm(urdf, srdf, tool_frame)
    at_home = _home(chain, semantics, home)
    if at_home is None:
        raise InputError(
            f"URDF {urdf}: no home: set robot.home, {len(chain.joint_names)} angles, or an SRDF with one"
        )
    fitted = _fitted(chain, frame, semantics, at_home).file if capsules is None else read_capsules(capsules)
    arm = assemble(chain, frame, semantics.never_colliding, fitted)
    return dataclasses.replace(arm, home=at_home)


def fit_known(name: str) -> "FittedArm":
    """Capsules fitted anew to an arm that is known by name; raises InputError."""
    if name not in ARMS:
        raise InputError(f"--model {name!r}: {unknown_arm(name)}")
    known = ARMS[name]
    chain, semantics = read_known(known)
    return _fitted(chain, known.tool_frame, semantics, np.array(known.home))


def fit_files(urdf: Path, srdf: Path | None, tool_frame: str, home: Sequence[float] | None) -> "FittedArm":
    """Capsules fitted to any arm; see model_from_files. Without a home, overlaps are looked for amid its limits."""
    chain, frame, semantics = read_arm(urdf, srdf, tool_frame)
    at_home = _home(chain, semantics, home)
    return _fitted(chain, frame, semantics, (chain.lower + chain.upper) / 2.0 if at_home is None else at_home)


def read_arm(urdf: Path, srdf: Path | None, tool_frame: str) -> tuple[Chain, str, Semantics]:
    """What the files of an arm say: the chain, the tool's frame, and what never collides."""
    semantics = Semantics(frozenset(), ()) if srdf is None else read_srdf(srdf)
    frame = tool_frame or semantics.tool_frame or tool_frame_of(urdf)
    chain = read_urdf(urdf, frame)
    never = chain.adjacent if srdf is None else semantics.never_colliding | chain.rigid
    return chain, frame, dataclasses.replace(semantics, never_colliding=never)


def _fitted(chain: Chain, tool_frame: str, semantics: Semantics, home: Array) -> "FittedArm":
    from farhand.robot_side.arm.fitting.arm import (
        fit_arm,  # scipy's optimisers and meshes: only where asked for
    )

    rng = stream(FIT_SEED, "arm fit")
    return fit_arm(chain, tool_frame, semantics.never_colliding, home, rng)


def _home(chain: Chain, semantics: Semantics, given: Sequence[float] | None) -> Array | None:
    """The configuration that is given, else the SRDF's; None: there is none."""
    if given is None:
        return semantics.home(chain.joint_names)
    if len(given) != len(chain.joint_names):
        raise InputError(wrong_length("home", len(given), chain.name, len(chain.joint_names)))
    return _within(given, chain)


def _named(settings: RobotSettings) -> ArmModel:
    arm = model(settings.known_model)
    return arm if settings.home is None else dataclasses.replace(arm, home=_within(settings.home, arm))


def _from_settings(settings: RobotSettings) -> ArmModel:
    files = [Path(each) if each else None for each in (settings.urdf, settings.srdf, settings.capsules)]
    stamps = tuple(_changed_ns(each) for each in files)
    return _cached(tuple(files), stamps, settings.tool_frame or "", settings.home)


@lru_cache(maxsize=8)
def _cached(
    files: tuple[Path | None, ...],
    stamps: tuple[int, ...],
    tool_frame: str,
    home: tuple[float, ...] | None,
) -> ArmModel:
    """As a scenario is checked before its robot is made, files are read, and capsules fitted, once."""
    urdf, srdf, capsules = files
    return model_from_files(urdf or Path(), srdf, capsules, tool_frame, home)


def _changed_ns(path: Path | None) -> int:
    try:
        return path.stat().st_mtime_ns if path is not None else 0
    except (OSError, ValueError):
        return 0


def _holding(arm: ArmModel, tool: ToolSettings) -> ArmModel:
    try:
        return with_tool(arm, np.array(tool.start), np.array(tool.end), tool.radius)
    except InputError as error:
        raise ScenarioError(f"robot.tool: {error}") from None


def _within(home: Sequence[float], arm: ArmModel | Chain) -> Array:
    at_home = np.array(home, dtype=float)
    outside = np.flatnonzero((at_home < arm.lower) | (at_home > arm.upper))
    if outside.size:
        raise InputError(f"home: {arm.joint_names[int(outside[0])]} would stand outside of its limits")
    return at_home
