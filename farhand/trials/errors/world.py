"""Operator, network and robot in virtual time, with a place for a hostile client at either end."""

from collections.abc import Callable

import msgspec
import numpy as np

from farhand.common.geometry import Twist, norm
from farhand.common.link.link import MemoryLink, Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key, state_key
from farhand.common.messages.state import RobotState
from farhand.common.seeds import stream
from farhand.common.timing.clock import to_ns
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor
from farhand.netem.control import handle
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.operator_node import OperatorIdentity
from farhand.operator_side.prepare import prepare
from farhand.programs.wiring import OPERATOR_NAME, make_netem, make_operator, make_robot_node, session_of
from farhand.robot_side.robots.point import PointRobot
from farhand.robot_side.scene.surroundings import Surroundings
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, load_scenario, replace_settings
from farhand.trials.errors.judge import Judge

START_NS = 1_000_000_000
COMPUTING_NS = 1_000_000
STANDING, STANDS_FOR_NS = 0.02, 300_000_000
"""Slower than this (m/s) for so long is standing."""
TARGETS = [[1.6, 0.0, 0.6], [1.6, 0.0, 1.4], [0.6, 0.0, 1.4], [0.6, 0.0, 0.6]] * 10
"""A velocity that always changes: of one that does not, what is played again looks as what is new."""
ACROSS = [[4.0, 0.0, 3.2], [0.6, 0.0, 0.6]] * 10
"""Behind an obstacle."""


def task(guarded: bool) -> Scenario:
    """A point that is driven round and round; with the guard past an obstacle that is in the way, and back."""
    plain = load_scenario("point-obstacle")
    settings: dict[str, object] = {"targets": ACROSS if guarded else TARGETS, "guard.on": guarded}
    if not guarded:
        settings["obstacles"] = []
    return replace_settings(plain, settings)


class Watched(PointRobot):
    """A point whose every period is looked at.

    Attributes:
        look: called with the twist that it was told and the speed that it then has (m/s).
    """

    look: Callable[[Twist, float], None] = staticmethod(lambda twist, speed: None)

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """See Robot."""
        super().step(twist, dt, surroundings)
        self.look(twist, norm(self.sample().velocity))


class World:
    """Args:
    seed: of all draws.
    network: SPEC of both directions.
    guarded: see task.

    Attributes:
        clock: of all.
        robot, operator, netem: the nodes.
        judge: see there.
        lawful: what the operator sent last, the newest at the end: payload and command.
        states: what the robot sent last: payload and state.
        speeds: of every period: when (ns) and how fast (m/s).
        at_robot, at_operator: the ends' own deliveries, past all that intercepts them.
        before_robot: where not None, is given each packet for the robot in its place; may deliver what it likes.
    """

    def __init__(self, seed: int, network: str, guarded: bool) -> None:
        scenario = task(guarded)
        run = msgspec.structs.replace(Run.over(scenario, network, seed=seed))
        self._executor = VirtualExecutor(START_NS)
        self.clock = self._executor.clock
        operator_end, netem_operator_end = self._executor.wire()
        netem_robot_end, robot_end = self._executor.wire()
        self.name = scenario.robot.kind
        self.key, self.state_key = command_key(self.name), state_key(self.name)
        self.session, self.operator_session = session_of(seed, "robot"), session_of(seed, "operator")
        self.judge = Judge(self.session, self.key, to_ns(scenario.safety.max_age))
        self.rng: np.random.Generator = stream(seed, "hostile")
        self.lawful: list[tuple[bytes, VelocityCommand]] = []
        self.states: list[tuple[bytes, RobotState]] = []
        self.scenes: list[tuple[str, bytes]] = []
        self.speeds: list[tuple[int, float]] = []
        self.before_robot: Callable[[Packet, int], None] | None = None
        self.at_robot, self.at_operator = robot_end.deliver, operator_end.deliver
        self._tap(operator_end, robot_end)
        moved = Watched.for_scenario(scenario)
        assert isinstance(moved, Watched)
        moved.look = self._look
        self.robot = make_robot_node(scenario, robot_end, self.name, self.session, moved)
        self.netem = make_netem(netem_operator_end, netem_robot_end, run)
        controller = make_controller(scenario.controller)
        prepare(controller)
        who = OperatorIdentity(self.name, self.operator_session, OPERATOR_NAME)
        self.operator = make_operator(scenario, operator_end, who, controller)
        self._executor.add(self.robot, Priority.ROBOT)
        self._executor.add(self.netem, Priority.NETEM)
        self._executor.add(self.operator, Priority.OPERATOR, lambda: COMPUTING_NS)
        for link in (netem_operator_end, netem_robot_end):
            self._executor.wake_on_message(self.netem, link)

    def at(self, instant_ns: int, call: Callable[[int], None]) -> None:
        """Have something done at an instant."""
        self._executor.call_at(instant_ns, Priority.NETEM, call)

    def set_network(self, spec: str, now_ns: int, direction: str = "both") -> None:
        """Change the network; raises AssertionError where it refuses."""
        request = msgspec.json.encode({"do": "set", "direction": direction, "spec": spec})
        said = msgspec.json.decode(handle(self.netem, request, now_ns))
        assert said["ok"], said

    def run(self, until_ns: int) -> None:
        """Let time pass."""
        self._executor.run_until(until_ns)

    def to_robot(self, payload: bytes, now_ns: int, key: str = "") -> None:
        """A foreign packet reaches the robot."""
        self.at_robot(Packet(key or self.key, payload), now_ns)

    def to_operator(self, payload: bytes, now_ns: int, key: str = "") -> None:
        """A foreign packet reaches the operator's side."""
        self.at_operator(Packet(key or self.state_key, payload), now_ns)

    def standing(self, from_ns: int, until_ns: int) -> float | None:
        """From an instant until it stood, before another one (s); None: it did not."""
        since_ns: int | None = None
        for t_ns, speed in self.speeds:
            if t_ns < from_ns or t_ns > until_ns:
                continue
            if speed > STANDING:
                since_ns = None
            elif since_ns is None:
                since_ns = t_ns
            if since_ns is not None and t_ns - since_ns >= STANDS_FOR_NS:
                return (since_ns - from_ns) * 1e-9
        return None

    def fastest(self, from_ns: int, until_ns: int) -> float:
        """Highest speed between two instants (m/s)."""
        return max((v for t_ns, v in self.speeds if from_ns <= t_ns <= until_ns), default=0.0)

    def _look(self, twist: Twist, speed: float) -> None:
        now_ns = self.clock.now_ns()
        self.judge.told(twist, now_ns)
        self.speeds.append((now_ns, speed))

    def _tap(self, operator_end: MemoryLink, robot_end: MemoryLink) -> None:
        operator_send, robot_send = operator_end.send, robot_end.send
        receive, deliver = robot_end.receive, robot_end.deliver
        commands, states = Decoder(VelocityCommand), Decoder(RobotState)

        def operator_sends(packet: Packet) -> None:
            command = commands.decode(packet.payload)
            if command is not None:
                self.judge.sent(packet.payload, command)
                self.lawful.append((packet.payload, command))
            operator_send(packet)

        def robot_sends(packet: Packet) -> None:
            if packet.key == self.state_key:
                state = states.decode(packet.payload)
                if state is not None:
                    self.states.append((packet.payload, state))
            else:
                self.scenes.append((packet.key, packet.payload))
            robot_send(packet)

        def robot_receives() -> list[Packet]:
            packets = receive()
            self.judge.taken(packets, self.clock.now_ns())
            return packets

        def robot_gets(packet: Packet, now_ns: int) -> None:
            if self.before_robot is not None:
                self.before_robot(packet, now_ns)
            else:
                deliver(packet, now_ns)

        operator_end.send, robot_end.send = operator_sends, robot_sends  # type: ignore[method-assign]
        robot_end.receive, robot_end.deliver = robot_receives, robot_gets  # type: ignore[method-assign]
