"""What a program can call on the emulated controller. Functions that take time are generators, a cycle a step."""

import math
from collections.abc import Callable, Generator, Sequence
from typing import Any

import numpy as np

from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.ur import poses
from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.sockets import ProgramSockets

Wait = Generator[None, None, None]

WAITS = (
    "sync", "sleep", "speedj", "speedl", "stopj", "stopl", "movej", "movel", "servoj", "socket_open",
    "socket_read_binary_integer",
)  # fmt: skip
NOTHING = (
    "textmsg", "force_mode_set_damping", "force_mode_set_gain_scaling", "force_mode", "end_force_mode", "zero_ftsensor",
    "teach_mode", "end_teach_mode", "set_gravity", "enable_external_ft_sensor", "ft_rtde_input_enable", "popup",
)  # fmt: skip
"""Accepted, and without effect here."""


class Functions:
    """One program's view of the controller.

    Args:
        controller: that it runs on.
        sockets: that it may open.
    """

    def __init__(self, controller: Controller, sockets: ProgramSockets) -> None:
        self._controller, self._sockets = controller, sockets
        self._kinematics = Kinematics(controller.arm)

    def table(self) -> dict[str, Callable[..., Any]]:
        """By the names that programs use."""
        controller, registers = self._controller, self._controller.registers
        found: dict[str, Callable[..., Any]] = dict.fromkeys(NOTHING, _nothing)
        found.update({name: getattr(self, name) for name in dir(self) if name[0] != "_" and name != "table"})
        found.update(
            {
                "missing": _missing,
                "pose": lambda *values: poses.Pose(values),
                "norm": lambda value: float(np.linalg.norm(value)),
                "get_steptime": lambda: controller.step_time,
                "protective_stop": lambda: controller.protective_stop("a program asked for it"),
                "read_input_integer_register": lambda i: registers.inputs[f"input_int_register_{int(i)}"],
                "read_input_float_register": lambda i: registers.inputs[f"input_double_register_{int(i)}"],
                "write_output_integer_register": lambda i, v: _write(
                    registers.outputs, f"int_register_{int(i)}", int(v)
                ),
                "write_output_float_register": lambda i, v: _write(
                    registers.outputs, f"double_register_{int(i)}", float(v)
                ),
                "get_actual_joint_positions": lambda: controller.physics.q.tolist(),
                "get_target_joint_positions": lambda: controller.motion.q.tolist(),
                "get_actual_joint_speeds": lambda: controller.physics.qd.tolist(),
                "get_target_joint_speeds": lambda: controller.motion.qd.tolist(),
                "get_actual_joint_positions_history": lambda steps=0: controller.physics.q.tolist(),
                "get_target_payload": lambda: controller.payload,
                "get_target_payload_cog": lambda: list(controller.payload_cog),
                "get_target_payload_inertia": lambda: [0.0] * 6,
                "get_tcp_offset": lambda: poses.Pose(controller.tcp),
                "is_steady": lambda: not controller.moves,
                "abs": abs,
                "sqrt": math.sqrt,
                "socket_close": self._sockets.close,
                "socket_send_int": self._sockets.send_int,
            }
        )
        return found

    def sync(self) -> Wait:
        """The rest of this cycle."""
        yield

    def sleep(self, t: float) -> Wait:
        """t s."""
        yield from self._cycles(t)

    def speedj(self, qd: Sequence[float], a: float = 1.4, t: float | None = None) -> Wait:
        """Joint speeds; returns after t s, or once they are reached. They stay until something else is asked for."""
        motion = self._controller.motion
        motion.speed(np.array(qd, dtype=float), float(a))
        yield from self._settle(t)

    def speedl(self, xd: Sequence[float], a: float = 1.2, t: float | None = None, aRot: str = "a") -> Wait:
        """Speed of the tool."""
        self._controller.motion.speed_of_tool(np.array(list(xd), dtype=float), float(a))
        yield from self._settle(t)

    def stopj(self, a: float = 2.0) -> Wait:
        """Brake until the arm stands."""
        self._controller.motion.stop(float(a))
        while not self._controller.motion.stands:
            yield

    def stopl(self, a: float = 2.0, aRot: float = 0.0) -> Wait:
        """Brake until the arm stands; here the joints brake together."""
        motion = self._controller.motion
        fastest = float(np.abs(motion.qd).max())
        J = self._controller.chain.at(motion.q, motion.qd).jacobian
        length = float(np.linalg.norm(J[:3] @ motion.qd))
        yield from self.stopj(float(a) * fastest / length if length > 1e-6 else float(a))

    def movej(
        self, q: Sequence[float], a: float = 1.4, v: float = 1.05, t: float = 0.0, r: float = 0.0
    ) -> Wait:
        """To joint positions, or to a pose."""
        goal = self.get_inverse_kin(q) if isinstance(q, poses.Pose) else q
        self._controller.motion.go(np.array(goal, dtype=float), float(a), float(v))
        while not self._controller.motion.settled:
            yield
        self._controller.motion.stop(float(a))

    def movel(
        self, pose: Sequence[float], a: float = 1.2, v: float = 0.25, t: float = 0.0, r: float = 0.0
    ) -> Wait:
        """To a pose; here the joints lead, and the line is none."""
        yield from self.movej(pose, a, v)

    def servoj(
        self,
        q: Sequence[float],
        a: float = 0.0,
        v: float = 0.0,
        t: float = 0.002,
        lookahead_time: float = 0.1,
        gain: float = 300.0,
    ) -> Wait:
        """After a goal that moves."""
        self._controller.motion.servo(np.array(q, dtype=float), float(lookahead_time))
        yield from self._cycles(t)

    def get_target_tcp_speed(self) -> list[float]:
        """Of the flange, in the controller's base."""
        motion = self._controller.motion
        J = self._controller.chain.at(motion.q, motion.qd).jacobian
        return poses.to_base((J @ motion.qd).tolist())

    def get_actual_tcp_pose(self) -> poses.Pose:
        """Of the tool's centre point, in the controller's base."""
        return self.get_forward_kin(self._controller.physics.q.tolist())

    def get_actual_tool_flange_pose(self) -> poses.Pose:
        """Of the flange."""
        return self.get_forward_kin(self._controller.physics.q.tolist(), [0.0] * 6)

    def get_target_waypoint(self) -> poses.Pose:
        """Where it is going: here, where it is."""
        return self.get_actual_tcp_pose()

    def get_forward_kin(
        self, q: Sequence[float] | None = None, tcp: Sequence[float] | None = None
    ) -> poses.Pose:
        """Pose of the tool's centre point at joint positions."""
        controller = self._controller
        at = controller.physics.q if q is None else np.array(q, dtype=float)
        return poses.tcp_pose(controller.arm, at, controller.tcp if tcp is None else tcp)

    def get_inverse_kin(
        self, x: Sequence[float], qnear: Sequence[float] | None = None, *_: float
    ) -> list[float]:
        """Joint positions of a pose; the program ends where there are none."""
        found = self._inverse(x, qnear)
        if found is None:
            raise ValueError("get_inverse_kin: no solution")
        return found

    def get_inverse_kin_has_solution(
        self, x: Sequence[float], qnear: Sequence[float] | None = None, *_: float
    ) -> bool:
        """Whether there are any."""
        return self._inverse(x, qnear) is not None

    def is_within_safety_limits(self, where: Sequence[float]) -> bool:
        """Whether joint positions, or a pose, are within the joints' limits."""
        arm = self._controller.arm
        if isinstance(where, poses.Pose):
            return self._inverse(where, None) is not None
        q = np.array(where, dtype=float)
        return bool(np.all((q >= arm.lower) & (q <= arm.upper)))

    def pose_trans(self, one: Sequence[float], other: Sequence[float]) -> poses.Pose:
        """The product of two poses."""
        return poses.product(one, other)

    def pose_sub(self, one: Sequence[float], other: Sequence[float]) -> poses.Pose:
        """Difference of positions, and the rotation that is between."""
        return poses.difference(one, other)

    def set_payload(self, mass: float, cog: Sequence[float] | None = None) -> None:
        """(kg), (m)."""
        self._controller.payload = float(mass)
        if cog is not None:
            self._controller.payload_cog = [float(each) for each in cog]

    def set_target_payload(
        self, mass: float, cog: Sequence[float] | None = None, inertia: Sequence[float] | None = None
    ) -> None:
        """As set_payload; inertia has no effect here."""
        self.set_payload(mass, cog)

    def set_tcp(self, pose: Sequence[float]) -> None:
        """Offset of the tool's centre point from the flange."""
        self._controller.tcp = [float(each) for each in pose]

    def rtde_set_watchdog(self, register: str, min_frequency: float, action: str = "pause") -> None:
        """See Controller.set_watchdog; the action is a protective stop here, whatever is said."""
        self._controller.set_watchdog(register, float(min_frequency))

    def freedrive_mode(self, freeAxes: Any = None, feature: Any = None) -> None:
        """The arm can be led by hand: here it stands."""
        self._controller.motion.stop(2.0)

    def end_freedrive_mode(self) -> None:
        """It cannot any more."""

    def get_freedrive_status(self) -> int:
        """0: it is led freely."""
        return 0

    def get_joint_torques(self) -> list[float]:
        """Not measured here."""
        return [0.0] * self._controller.arm.n

    def tool_contact(self, direction: Any = None) -> int:
        """There is nothing that it could touch."""
        return 0

    def socket_open(
        self, address: str, port: int, socket_name: str = "socket_0"
    ) -> Generator[None, None, bool]:
        """Connect to a server; whether it answered within 2 s."""
        if not self._sockets.open(address, int(port), socket_name):
            return False
        for _ in range(round(2.0 / self._controller.step_time)):
            state = self._sockets.state(socket_name)
            if state is not None:
                return state
            yield
        self._sockets.close(socket_name)
        return False

    def socket_read_binary_integer(
        self, number: int, socket_name: str = "socket_0", timeout: float = 2.0
    ) -> Generator[None, None, list[int]]:
        """How many integers came, and they; 0 after `timeout` s (0: wait for ever), -1 where nobody is there."""
        started = self._controller.now
        while True:
            values = self._sockets.read_integers(socket_name, int(number))
            if values is not None:
                return values
            if timeout > 0.0 and self._controller.now - started >= timeout - 1e-9:
                return [0] + [-1] * int(number)
            yield

    def _cycles(self, t: float) -> Wait:
        for _ in range(max(1, round(t / self._controller.step_time))):
            yield

    def _settle(self, t: float | None) -> Wait:
        if t is not None and t > 0.0:
            yield from self._cycles(t)
            return
        yield
        while not self._controller.motion.settled:
            yield

    def _inverse(self, x: Sequence[float], qnear: Sequence[float] | None) -> list[float] | None:
        controller = self._controller
        near = controller.physics.q if qnear is None else np.array(qnear, dtype=float)
        position, R = poses.flange_of(x, controller.tcp)
        found = self._kinematics.inverse(position, R, near)
        return None if found is None else found.tolist()


def _write(outputs: dict[str, Any], name: str, value: int | float) -> None:
    key = f"output_{name}"
    if key not in outputs:
        raise ValueError(f"there is no {key}")
    outputs[key] = value


def _nothing(*_: Any, **__: Any) -> None:
    """Accepted."""


def _missing(name: str) -> None:
    raise NotImplementedError(f"{name}() is not emulated")
