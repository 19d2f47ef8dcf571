"""An operator that drives the tool to and fro, asks for control, and acknowledges only when it is told to."""

import threading

from farhand.common.link.link import Packet
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import CommandMode, VelocityCommand
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import command_key, state_key
from farhand.common.messages.state import RobotState
from farhand.common.quantities import ZERO, Vector3
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.programs.sessions import random_session

PERIOD = 0.02
AXIS, LOW, HIGH = 1, -0.32, -0.18
"""Along y the tool goes to and fro between these (m)."""


class Hand:
    """Commands at 50 Hz in a thread of its own; what it heard last is in `state`.

    Args:
        endpoint: of the robot's program.
        robot: its name.
        speed: of the tool (m/s).

    Attributes:
        silent: whether it sends nothing.
        state: the robot's newest; None before the first.
    """

    def __init__(self, endpoint: str, robot: str, speed: float) -> None:
        self._clock, self._speed = SystemClock(), speed
        self._robot = robot
        self._session = random_session()
        self._link = ZenohLink(open_session([endpoint]), [state_key(robot)], self._clock)
        self._decoder, self._newest = Decoder(RobotState), Newest()
        self._over = threading.Event()
        self._mode: CommandMode = "run"
        self.silent = False
        self._forward = True
        self.state: RobotState | None = None
        self.heard_ns = 0
        self._seq = 0
        self._thread = threading.Thread(target=self._work, name="hand", daemon=True)
        self._thread.start()

    def acknowledge(self) -> None:
        """Acknowledge once, or ask for control."""
        self._mode = "acknowledge"

    def stop(self) -> None:
        """An emergency stop."""
        self._mode = "estop"

    def close(self) -> None:
        """Let go."""
        self._over.set()
        self._thread.join()
        self._link.close()

    def _work(self) -> None:
        next_ns = self._clock.now_ns()
        while not self._over.is_set():
            now_ns = self._clock.now_ns()
            for packet in self._link.receive():
                state = self._decoder.decode(packet.payload)
                if state is not None and self._newest.accept(state, packet.arrived_ns or now_ns):
                    self.state, self.heard_ns = state, now_ns
            if not self.silent:
                self._send(now_ns)
            next_ns += to_ns(PERIOD)
            self._clock.sleep_until(next_ns)

    def _send(self, now_ns: int) -> None:
        mode, self._mode = self._mode, "run"
        self._seq += 1
        command = VelocityCommand(
            source="hand",
            session=self._session,
            seq=self._seq,
            t_sent_ns=now_ns,
            echo=self._newest.echo(now_ns),
            mode=mode,
            velocity=self._velocity() if mode == "run" else ZERO,
        )
        self._link.send(Packet(command_key(self._robot), encode(command)))

    def _velocity(self) -> Vector3:
        if self.state is None:
            return ZERO
        at = self.state.position[AXIS]
        if at > HIGH:
            self._forward = False
        elif at < LOW:
            self._forward = True
        return (0.0, self._speed if self._forward else -self._speed, 0.0)
