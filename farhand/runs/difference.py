"""Where an operator's own scenario differs from what the robot says of itself."""

from farhand.common.messages.description import RobotDescription
from farhand.runs.scenario import Scenario

_COMPARED = (
    ("lag", "robot", "s"),
    ("radius", "robot", "m"),
    ("rate_hz", "robot", "Hz"),
    ("state_rate_hz", "robot", "Hz"),
    ("max_speed", "safety", "m/s"),
    ("max_age", "safety", "s"),
    ("command_timeout", "safety", "s"),
)
"""Field of the description, section of the scenario in which it has the same name, unit."""


def difference(robot: RobotDescription, scenario: Scenario) -> str:
    """One line for the operator, or an empty string where both say the same."""
    found = []
    if robot.kind != scenario.robot.kind:
        found.append(f"robot.kind {robot.kind} (here {scenario.robot.kind})")
    for name, section, unit in _COMPARED:
        there, here = getattr(robot, name), getattr(getattr(scenario, section), name)
        if there != here:
            found.append(f"{section}.{name} {there:g} {unit} (here {here:g})")
    if not found:
        return ""
    return f"robot {robot.source!r} is another one than this scenario says; in force is: {', '.join(found)}"
