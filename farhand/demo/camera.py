"""The camera's program among those of the demo."""

import dataclasses
from collections.abc import Sequence

from farhand.programs.command_line import CameraWords, RobotWords, Words


def with_camera(wanted: Sequence[Words], camera: str, beside_robot: str) -> list[Words]:
    """The same programs, and a camera that hears the robot on an endpoint of its own, as no network lies between.

    Args:
        wanted: the robot's among them.
        camera: as `farhand camera --camera` has it.
        beside_robot: that endpoint.
    """
    found: list[Words] = []
    beside: list[Words] = []
    for words in wanted:
        if isinstance(words, RobotWords):
            beside.append(
                CameraWords(
                    camera=camera,
                    scenario=words.scenario,
                    robot=words.robot,
                    connect=(beside_robot, *words.connect),
                )
            )
            words = dataclasses.replace(words, listen=(*words.listen, beside_robot))
        found.append(words)
    return found + beside
