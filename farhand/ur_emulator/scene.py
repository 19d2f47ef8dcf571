"""Where a scenario's arm stands at its start."""

from farhand.common.errors import InputError
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.robots.arms import chosen_arm
from farhand.runs.scenario import load_scenario


def start_in(name: str, model: str) -> tuple[str, tuple[float, ...]]:
    """The model of a scenario's arm, and its joints at the scenario's start (rad).

    Args:
        name: of the scenario, or its file.
        model: that is wanted; empty: the scenario's.

    Raises InputError where the scenario has no such arm, or it cannot stand there.
    """
    scenario = load_scenario(name)
    settings = scenario.robot
    if not settings.known_model.startswith("ur"):
        raise InputError(f"--scenario {name}: its robot is no UR arm")
    if model and model != settings.known_model:
        raise InputError(f"--model {model}: the scenario's arm is a {settings.known_model}")
    seed = settings.joints
    kinematics = Kinematics(chosen_arm(settings))
    q = kinematics.inverse_tool_down(scenario.start, None if seed is None else kinematics.lower * 0 + seed)
    if q is None:
        raise InputError(f"--scenario {name}: the arm cannot reach its start")
    return settings.known_model, tuple(q.tolist())
