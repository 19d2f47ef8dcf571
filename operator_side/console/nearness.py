"""How near the tool is to an obstacle, at the instant of the newest state: what a sentence that names both may say."""

from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import moved
from farhand.operator_side.console.picture import Picture


def tool_to(picture: Picture, name: str) -> float | None:
    """From the sphere around the tool to the obstacle of that name (m); None where one of the two is not known."""
    state, scene, robot = picture.state, picture.scene, picture.description
    if state is None or scene is None or robot is None:
        return None
    found = next((each for each in scene.obstacles if each.id == name), None)
    if found is None:
        return None
    there = moved(found, (state.t_sample_ns - scene.t_sample_ns) * 1e-9)
    return distance_to(there, state.position) - robot.radius
