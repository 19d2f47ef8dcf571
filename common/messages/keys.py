"""Zenoh keys: `farhand/<robot>/<kind>`."""

import re

from farhand.common.errors import InputError

PREFIX = "farhand"
_ROBOT_NAME = re.compile(r"[A-Za-z0-9_.-]{1,32}\Z")


def check_robot_name(name: str) -> str:
    """The name itself if it can be part of a key; raises InputError otherwise."""
    if not _ROBOT_NAME.match(name):
        raise InputError(
            f"--robot {name!r}: a robot's name is 1 to 32 letters, digits, dots, dashes or underscores"
        )
    if name == "netem":
        raise InputError("--robot 'netem': is the emulator's own name; choose another")
    return name


def command_key(robot: str) -> str:
    """Operator to robot: VelocityCommand."""
    return f"{PREFIX}/{robot}/command"


def state_key(robot: str) -> str:
    """Robot to operator: RobotState."""
    return f"{PREFIX}/{robot}/state"


def scene_key(robot: str) -> str:
    """Robot to operator: Scene."""
    return f"{PREFIX}/{robot}/scene"


def scene_request_key(robot: str) -> str:
    """Whoever may command to robot: SceneRequest."""
    return f"{PREFIX}/{robot}/scene_request"


def description_key(robot: str) -> str:
    """Robot to operator: RobotDescription."""
    return f"{PREFIX}/{robot}/description"


def camera_key(robot: str) -> str:
    """A camera on the robot's side to operator: CameraFrame."""
    return f"{PREFIX}/{robot}/camera"


def report_key(robot: str) -> str:
    """Operator to its own console and recorder: ControlReport."""
    return f"{PREFIX}/{robot}/report"


def mirror_key(robot: str, kind: str) -> str:
    """Operator to its own console, as it came or left: a message of that kind (state, scene, description, command).

    Under keys of their own, so that nobody who looks for the robot takes its operator's console for it.
    """
    return f"{PREFIX}/{robot}/mirror/{kind}"


def steering_key(robot: str) -> str:
    """Console, gamepad or bridge to the operator, on its own host: Steering."""
    return f"{PREFIX}/{robot}/steering"


def handover_key(robot: str) -> str:
    """Queryable of an operator's program, on its own host: hand control over."""
    return f"{PREFIX}/{robot}/handover"


def estop_key(robot: str) -> str:
    """Queryable of an operator's program, on its own host: stop the robot for good."""
    return f"{PREFIX}/{robot}/estop"


def acknowledge_key(robot: str) -> str:
    """Queryable of an operator's program, on its own host: acknowledge the robot's stop."""
    return f"{PREFIX}/{robot}/acknowledge"


def scene_change_key(robot: str) -> str:
    """Queryable of an operator's program, on its own host: change the robot's scene."""
    return f"{PREFIX}/{robot}/scene_change"


def ticks_key(robot: str) -> str:
    """Queryable of an operator's program, on its own host: its newest ticks, for a recorder."""
    return f"{PREFIX}/{robot}/ticks"


def alive_key(robot: str, role: str) -> str:
    """Liveliness token of a program: role is operator, robot or netem (whose robot is `netem`)."""
    return f"{PREFIX}/{robot}/alive/{role}"


def about_key(robot: str, role: str) -> str:
    """Queryable of a program that says what it is: versions, schema, rights, certificate."""
    return f"{PREFIX}/{robot}/about/{role}"


def robot_of(key: str) -> str:
    """The robot that a key belongs to; empty if it is none of ours."""
    parts = key.split("/")
    return parts[1] if len(parts) >= 3 and parts[0] == PREFIX else ""


def kind_of(key: str) -> str:
    """The kind of message under a key: command, state, scene, camera, report, ...; empty if none of ours."""
    parts = key.split("/")
    return parts[2] if len(parts) >= 3 and parts[0] == PREFIX else ""
