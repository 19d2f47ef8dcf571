"""Where an operator's own scenario differs from what the robot says of itself."""

from farhand.common.messages.description import RobotDescription
from farhand.common.messages.scene import Obstacle, Scene
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
    same_arm = (
        robot.model != "" and robot.model == scenario.robot.known_model
    )  # a real one, in place of a simulated
    if robot.kind != scenario.robot.kind and not same_arm:
        found.append(f"robot.kind {robot.kind} (here {scenario.robot.kind})")
    for name, section, unit in _COMPARED:
        there, here = getattr(robot, name), getattr(getattr(scenario, section), name)
        if there != here:
            found.append(f"{section}.{name} {there:g} {unit} (here {here:g})")
    if not found:
        return ""
    return f"robot {robot.source!r} is another one than this scenario says; in force is: {', '.join(found)}"


def scene_difference(scene: Scene, scenario: Scenario) -> str:
    """One line where the robot has other obstacles or targets than the scenario; else an empty string.

    Of obstacles that move only size and way are compared: where they are by now is the robot's to say.
    """
    there, here = _fixed(scene.obstacles), _fixed(scenario.obstacles)
    found = [f"obstacle {name!r} is only {place}" for name, place in _only_once(there, here)]
    found += [f"obstacle {name!r} differs" for name in there if name in here and there[name] != here[name]]
    if scene.targets != scenario.targets:
        found.append(f"{len(scene.targets)} targets there, {len(scenario.targets)} here, not the same")
    if not found:
        return ""
    others = ", ".join(found)
    return f"robot {scene.source!r} has another scene than this scenario says; its own is in force: {others}"


def _fixed(obstacles: tuple[Obstacle, ...]) -> dict[str, object]:
    """What of each obstacle does not change with time."""
    return {
        o.id: (
            *(o.shape, o.orientation, o.acceleration, o.path, o.speed),
            *((None, None) if o.path else (o.velocity, None if o.moves else o.position)),
        )
        for o in obstacles
    }


def _only_once(there: dict[str, object], here: dict[str, object]) -> list[tuple[str, str]]:
    return [(n, "there") for n in there if n not in here] + [(n, "here") for n in here if n not in there]
