"""What RTDE can be asked for: the variables by name, their types, and where they come from."""

from collections.abc import Callable
from typing import Any

from farhand.robot_side.ur import poses
from farhand.ur_emulator.controller import Controller, RobotMode, Runtime, SafetyMode

Getter = Callable[[Controller], Any]

_NONE6 = [0.0] * 6
JOINT_RUNNING, JOINT_OFF = 253, 239


def _robot_status(controller: Controller) -> int:
    powered = controller.robot_mode >= RobotMode.POWER_ON
    freed = controller.robot_mode == RobotMode.BACKDRIVE
    return powered | (controller.runtime == Runtime.PLAYING) << 1 | freed << 2


def _safety_status(controller: Controller) -> int:
    mode = controller.safety_mode
    bits = {
        SafetyMode.NORMAL: 0,
        SafetyMode.REDUCED: 1,
        SafetyMode.PROTECTIVE_STOP: 2,
        SafetyMode.RECOVERY: 3,
        SafetyMode.SAFEGUARD_STOP: 4,
        SafetyMode.SYSTEM_EMERGENCY_STOP: 5,
        SafetyMode.ROBOT_EMERGENCY_STOP: 6,
        SafetyMode.VIOLATION: 8,
        SafetyMode.FAULT: 9,
    }
    emergency = mode in (SafetyMode.SYSTEM_EMERGENCY_STOP, SafetyMode.ROBOT_EMERGENCY_STOP)
    return 1 << bits[mode] | emergency << 7 | controller.stopped_by_safety << 10


def _tcp_pose(controller: Controller) -> list[float]:
    return poses.tcp_pose(controller.arm, controller.physics.q, controller.tcp)


def _tcp_speed(controller: Controller) -> list[float]:
    physics = controller.physics
    J = controller.chain.at(physics.q, physics.qd).jacobian
    return poses.to_base((J @ physics.qd).tolist())


def _joint_mode(controller: Controller) -> list[int]:
    powered = controller.robot_mode in (RobotMode.RUNNING, RobotMode.BACKDRIVE)
    return [JOINT_RUNNING if powered else JOINT_OFF] * controller.arm.n


OUTPUTS: dict[str, tuple[str, Getter]] = {
    "timestamp": ("DOUBLE", lambda c: c.now),
    "target_q": ("VECTOR6D", lambda c: c.motion.q.tolist()),
    "target_qd": ("VECTOR6D", lambda c: c.motion.qd.tolist()),
    "actual_q": ("VECTOR6D", lambda c: c.physics.q.tolist()),
    "actual_qd": ("VECTOR6D", lambda c: c.physics.qd.tolist()),
    "actual_TCP_pose": ("VECTOR6D", _tcp_pose),
    "target_TCP_pose": ("VECTOR6D", _tcp_pose),
    "actual_TCP_speed": ("VECTOR6D", _tcp_speed),
    "target_TCP_speed": ("VECTOR6D", _tcp_speed),
    "robot_mode": ("INT32", lambda c: int(c.robot_mode)),
    "safety_mode": ("INT32", lambda c: int(c.safety_mode)),
    "runtime_state": ("UINT32", lambda c: int(c.runtime)),
    "robot_status_bits": ("UINT32", _robot_status),
    "safety_status_bits": ("UINT32", _safety_status),
    "joint_mode": ("VECTOR6INT32", _joint_mode),
    "speed_scaling": ("DOUBLE", lambda c: c.scaling),
    "target_speed_fraction": ("DOUBLE", lambda c: c.slider),
    "payload": ("DOUBLE", lambda c: c.payload),
    "payload_cog": ("VECTOR3D", lambda c: c.payload_cog),
    "tcp_offset": ("VECTOR6D", lambda c: c.tcp),
}
"""Those that are emulated."""

_ZEROS = {
    "VECTOR6D": "target_qdd target_current target_moment actual_current joint_control_output actual_TCP_force "
    "joint_temperatures actual_joint_voltage ft_raw_wrench payload_inertia",
    "VECTOR3D": "actual_tool_accelerometer tool_accelerometer",
    "DOUBLE": "actual_execution_time actual_momentum actual_main_voltage actual_robot_voltage actual_robot_current "
    "standard_analog_input0 standard_analog_input1 standard_analog_output0 standard_analog_output1",
    "UINT64": "actual_digital_input_bits actual_digital_output_bits",
}
"""Those that are there, and always zero."""

INPUTS = {
    "speed_slider_mask": "UINT32",
    "speed_slider_fraction": "DOUBLE",
    "external_force_torque": "VECTOR6D",
    "standard_digital_output_mask": "UINT8",
    "standard_digital_output": "UINT8",
    "configurable_digital_output_mask": "UINT8",
    "configurable_digital_output": "UINT8",
    "tool_digital_output_mask": "UINT8",
    "tool_digital_output": "UINT8",
    "standard_analog_output_mask": "UINT8",
    "standard_analog_output_type": "UINT8",
    "standard_analog_output_0": "DOUBLE",
    "standard_analog_output_1": "DOUBLE",
}
"""Inputs that are no registers."""


def _zero(kind: str) -> Getter:
    zero: Any = {"VECTOR6D": _NONE6, "VECTOR3D": _NONE6[:3], "DOUBLE": 0.0, "UINT64": 0}[kind]
    return lambda c: zero


for _kind, _names in _ZEROS.items():
    OUTPUTS.update({_name: (_kind, _zero(_kind)) for _name in _names.split()})


def output_of(name: str) -> tuple[str, Getter] | None:
    """Type of an output and how it is read; None: there is none of that name."""
    if name in OUTPUTS:
        return OUTPUTS[name]
    kind = _register_type(name, "output")
    return None if kind is None else (kind, lambda c: c.registers.outputs.get(name, 0))


def input_type(name: str) -> str | None:
    """Type of an input; None: there is none of that name."""
    return INPUTS.get(name) or _register_type(name, "input")


def _register_type(name: str, way: str) -> str | None:
    for word, kind, number in (("int", "INT32", 48), ("double", "DOUBLE", 48), ("bit", "BOOL", 128)):
        prefix = f"{way}_{word}_register_"
        index = name[len(prefix) :]
        if name.startswith(prefix) and index.isdecimal() and str(int(index)) == index and int(index) < number:
            return kind
    return None
