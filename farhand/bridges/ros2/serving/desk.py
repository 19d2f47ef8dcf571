"""What the services do: asked of the operator's program beside this one, or of the robot itself."""

from collections.abc import Callable

import msgspec
import zenoh

from farhand.common.messages.keys import acknowledge_key, estop_key, ticks_key
from farhand.common.recording.batch import TickBatch, TicksWanted
from farhand.site.acknowledge import acknowledge
from farhand.site.estop import emergency_stop

PATIENCE = 6.0
NO_TICK = 1 << 62
"""Ticks from here on are asked for, of which there is none: what is wanted is what comes with them."""


class OperatorDesk:
    """Args:
    session: to the operator's report endpoint.
    robot: the robot's name.
    """

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self._session, self._robot = session, robot

    def estop(self) -> tuple[bool, str]:
        """Stop it for good."""
        return self._ask(estop_key(self._robot), "stopped; only an acknowledgement leads out of it")

    def acknowledge(self) -> tuple[bool, str]:
        """Clear its stop."""
        return self._ask(acknowledge_key(self._robot), "the robot has left its stop")

    def kept(self) -> float | None:
        """The distance that its controller keeps, without the margin (m); None: it has not said."""
        wanted = msgspec.json.encode(TicksWanted(since=NO_TICK))
        try:
            for reply in self._session.get(ticks_key(self._robot), payload=wanted, timeout=1.0):
                if reply.ok is not None:
                    batch = msgspec.msgpack.decode(reply.ok.payload.to_bytes(), type=TickBatch)
                    return batch.info.kept
        except (zenoh.ZError, msgspec.MsgspecError, ValueError):
            pass
        return None

    def _ask(self, key: str, done: str) -> tuple[bool, str]:
        try:
            for reply in self._session.get(key, payload=b"{}", timeout=PATIENCE):
                if reply.ok is not None:
                    said = msgspec.json.decode(reply.ok.payload.to_bytes())
                    return bool(said.get("ok")), done if said.get("ok") else str(said.get("error", "refused"))
        except (zenoh.ZError, msgspec.DecodeError, ValueError, AttributeError) as error:
            return False, f"the operator's program could not be asked: {error}"
        return (
            False,
            f"the operator's program has not answered in {PATIENCE:g} s; is it there, with --report?",
        )


class RobotDesk:
    """The same from the robot's side, as `farhand estop` and `farhand acknowledge` do it.

    Args:
        robot: the robot's name.
        connect: where it is heard.
        tls: certificate folder; empty: none.
    """

    def __init__(self, robot: str, connect: str, tls: str = "") -> None:
        self._robot, self._connect, self._tls = robot, connect, tls

    def estop(self) -> tuple[bool, str]:
        """Stop it for good."""
        return self._did(emergency_stop, "stopped; only an acknowledgement leads out of it")

    def acknowledge(self) -> tuple[bool, str]:
        """Clear its stop, where nobody holds control."""
        return self._did(acknowledge, "the robot has left its stop")

    def kept(self) -> float | None:
        """Not known on the robot's side."""
        return None

    def _did(self, what: Callable[..., int], done: str) -> tuple[bool, str]:
        code = what(self._robot, [self._connect], self._tls)
        return (
            code == 0,
            done if code == 0 else "not confirmed; why is said on the terminal of `farhand ros2`",
        )
