"""A scenario's arm, standing at the scenario's start."""

from dataclasses import dataclass

import numpy as np

from farhand.common.errors import InputError
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.robots.arms import chosen_arm
from farhand.runs.scenario import load_scenario
from farhand.ur_emulator.models import E_SERIES, FASTEST, EmulatedModel, emulated_model

JOINTS = 6


@dataclass(frozen=True, slots=True)
class Start:
    """Attributes:
    model: what the controller says that it is.
    arm: its kinematics, URDF and limits.
    joints: where it stands (rad).
    """

    model: EmulatedModel
    arm: ArmModel
    joints: tuple[float, ...]


def start_in(name: str, model: str) -> Start:
    """What a scenario says: one of the UR arms that are known by name, or any arm of six joints by its files.

    Args:
        name: of the scenario, or its file.
        model: that is wanted; empty: the scenario's.

    Raises InputError where the scenario has no such arm, or it cannot stand there.
    """
    scenario = load_scenario(name)
    settings = scenario.robot
    known = settings.known_model
    if settings.urdf is None and not known.startswith("ur"):
        raise InputError(f"--scenario {name}: its robot is no UR arm")
    if model and model != known:
        raise InputError(f"--model {model}: the scenario's arm is a {known or 'file'}")
    arm = chosen_arm(settings)
    if arm.n != JOINTS:
        raise InputError(f"--scenario {name}: a UR arm has {JOINTS} joints, not {arm.n}")
    seed = None if settings.joints is None else np.array(settings.joints)
    q = Kinematics(arm).inverse_tool_down(scenario.start, seed)
    if q is None:
        raise InputError(f"--scenario {name}: the arm cannot reach its start")
    emulated = emulated_model(known) if known else EmulatedModel("", arm.title, FASTEST, E_SERIES)
    return Start(emulated, arm, tuple(q.tolist()))
