"""The arm that a scenario's robot is: known by name or read from files, with what it holds."""

import dataclasses
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from farhand.common.errors import InputError, ScenarioError
from farhand.common.geometry import Array
from farhand.common.seeds import stream
from farhand.robot_side.arm.capsules import read_capsules
from farhand.robot_side.arm.model import ArmModel, assemble, model
from farhand.robot_side.arm.srdf import Semantics, read_srdf
from farhand.robot_side.arm.tool import with_tool
from farhand.robot_side.arm.urdf import Chain, read_urdf, tool_frame_of
from farhand.robot_side.robots.settings import RobotSettings, ToolSettings, wrong_length

FIT_SEED = 1
"""Of the configurations in which overlaps of fitted capsules are counted."""


def chosen_arm(settings: RobotSettings) -> ArmModel:
    """The model, with its tool, its accelerations within `robot.max_joint_acceleration`.

    Raises ScenarioError when a file cannot be used, or what is said of the arm does not fit it; the key is named.
    """
    arm = _named(settings) if settings.known_model else _from_settings(settings)
    _check_length("joints", settings.joints, arm.title, arm.n)
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
    at_home = semantics.home(chain.joint_names) if home is None else np.array(home, dtype=float)
    if at_home is None:
        raise InputError(
            f"URDF {urdf}: no home: set robot.home, {len(chain.joint_names)} angles, or an SRDF with one"
        )
    _check_length("home", at_home, chain.name, len(chain.joint_names))
    outside = np.flatnonzero((at_home < chain.lower) | (at_home > chain.upper))
    if outside.size:
        joint = chain.joint_names[int(outside[0])]
        raise InputError(f"URDF {urdf}: home: joint {joint!r} would stand outside of its limits")
    if capsules is not None:
        fitted = read_capsules(capsules)
    else:
        from farhand.robot_side.arm.fitting.arm import fit_arm

        rng = stream(FIT_SEED, "arm fit")
        fitted = fit_arm(chain, frame, semantics.never_colliding, at_home, rng).file
    arm = assemble(chain, frame, semantics.never_colliding, fitted)
    return dataclasses.replace(arm, home=at_home)


def read_arm(urdf: Path, srdf: Path | None, tool_frame: str) -> tuple[Chain, str, Semantics]:
    """What the files of an arm say: the chain, the tool's frame, and what never collides."""
    semantics = Semantics(frozenset(), ()) if srdf is None else read_srdf(srdf)
    frame = tool_frame or semantics.tool_frame or tool_frame_of(urdf)
    chain = read_urdf(urdf, frame)
    if srdf is None:
        semantics = Semantics(chain.adjacent, ())
    return chain, frame, semantics


def _named(settings: RobotSettings) -> ArmModel:
    try:
        arm = model(settings.known_model)
    except InputError as error:
        raise ScenarioError(f"robot.model: {error}") from None
    if settings.home is None:
        return arm
    return dataclasses.replace(arm, home=_within(settings.home, arm))


def _from_settings(settings: RobotSettings) -> ArmModel:
    files = [Path(each) if each else None for each in (settings.urdf, settings.srdf, settings.capsules)]
    stamps = tuple(_changed_ns(each) for each in files)
    try:
        return _cached(tuple(files), stamps, settings.tool_frame or "", settings.home)
    except InputError as error:
        raise ScenarioError(f"robot: {error}") from None


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


def _within(home: Sequence[float], arm: ArmModel) -> Array:
    at_home = np.array(home)
    outside = np.flatnonzero((at_home < arm.lower) | (at_home > arm.upper))
    if outside.size:
        raise ScenarioError(
            f"robot.home: {arm.joint_names[int(outside[0])]} would stand outside of its limits"
        )
    return at_home


def _check_length(key: str, given: Sequence[float] | Array | None, title: str, joints: int) -> None:
    if given is not None and len(given) != joints:
        raise ScenarioError("robot." + wrong_length(key, len(given), title, joints))
