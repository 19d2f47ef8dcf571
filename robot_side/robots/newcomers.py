"""Whether obstacles may come to be where they are said to be: not on a robot, nor nearer than it keeps."""

from collections.abc import Sequence

from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.distance import nearest_obstacle
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.safety.guard.crowding import Crowding
from farhand.robot_side.safety.guard.tool_guard import ToolGuard
from farhand.robot_side.scene.surroundings import surroundings_of


def crowded_by(
    obstacles: Sequence[Obstacle],
    robot: Robot,
    sample: RobotSample,
    radius: float,
    guard: ToolGuard | bool,
    d_min: float,
) -> str:
    """One line that names a part and an obstacle; empty where all can be there.

    Args:
        obstacles: that come.
        robot, sample: and its state now.
        radius: of the sphere around its tool (m).
        guard: of the sphere, where the robot's program guards that; else whether the robot guards itself.
        d_min: what a guard keeps (m).
    """
    if not obstacles:
        return ""
    around = surroundings_of(obstacles)
    found: Crowding | None
    if isinstance(guard, ToolGuard):
        found = guard.crowded(sample.position, sample.velocity, around)
        return str(found) if found is not None else ""
    found = robot.crowded(around) if guard else _touched(robot, tuple(obstacles))
    if found is None:
        gap, name = nearest_obstacle(obstacles, sample.position)
        limit = d_min if guard else 0.0
        found = (
            Crowding("the sphere around the tool", name, gap - radius, limit)
            if gap - radius < limit
            else None
        )
    return str(found) if found is not None else ""


def _touched(robot: Robot, obstacles: tuple[Obstacle, ...]) -> Crowding | None:
    """What the body of a robot without a guard reaches into."""
    clearance = robot.arm_clearance(obstacles)
    if clearance is None or clearance > 0.0:
        return None
    part, name = robot.nearest_part(obstacles)
    return Crowding(part, name, clearance, 0.0)
