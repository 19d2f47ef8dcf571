"""A controller as the driver sees it: its newest state, and joint speeds sent to Farhand's program there."""

import secrets
from collections.abc import Sequence

from farhand.common.timing.clock import to_ns
from farhand.robot_side.ur.errands import Errands
from farhand.robot_side.ur.program import HEARD, INPUTS, RUN, message, program_text
from farhand.robot_side.ur.rtde_client import RtdeClient, Wanted
from farhand.robot_side.ur.settings import UrSettings
from farhand.robot_side.ur.states import OPTIONAL, OUTPUTS, STALE, Facts, may_start, slowed

TRY_AGAIN = 2.0
"""s from the start of a program until the next try."""
LARGEST = 0x7FFF_FFFF


class UrLink:
    """Polled by the driver; starts the program whenever nothing forbids it. That moves nothing.

    Args:
        host: address of the controller.
        settings: of the arm.
        acceleration: of the joints (rad/s^2), with which the program follows.

    Attributes:
        client: of RTDE.
        run: number of the program's run that was started last; 0: none.
    """

    def __init__(self, host: str, settings: UrSettings, acceleration: float) -> None:
        self._settings, self._acceleration = settings, acceleration
        self.client = RtdeClient(host, Wanted(OUTPUTS, OPTIONAL, INPUTS))
        self._errands = Errands(host)
        self.run = 0
        self._number = 0
        self._heard, self._heard_ns = -1, 0
        self._tried_ns: int | None = None
        self._sent_ns: dict[int, int] = {}
        self.round_trip = 0.0
        self._longest = 0.0

    def poll(self, now_ns: int, *, starts: bool = True) -> Facts:
        """Hear what has come; `starts`: run the program where it may run and does not. Returns what is known."""
        client = self.client
        if client.poll(now_ns):
            self._note_answer(now_ns)
        facts = self.facts(now_ns)
        if starts and may_start(facts) and self._is_old_try(now_ns):
            self._start(now_ns)
        return facts

    def facts(self, now_ns: int) -> Facts:
        """What is known now."""
        client = self.client
        age = 1e9 if client.arrived_ns is None else (now_ns - client.arrived_ns) * 1e-9
        return Facts(
            values=client.values,
            age=age,
            trouble=client.trouble,
            remote=self._errands.remote,
            run=self.run,
            unsent=self._errands.trouble,
            answer_age=max(0.0, (now_ns - self._heard_ns) * 1e-9),
        )

    def send(self, qd: Sequence[float], now_ns: int) -> None:
        """Joint speeds (rad/s) for the next cycle."""
        if self._unanswered(now_ns) > STALE:
            return  # none is sent until some are answered, so that none queues up
        self._number = self._number % LARGEST + 1
        sent = self.client.send(message(self._number, self._settings.deadline_time, self.run, qd))
        if sent and self._runs():
            self._sent_ns[self._number] = now_ns
            while len(self._sent_ns) > 1000:
                self._sent_ns.pop(next(iter(self._sent_ns)))

    def try_again(self) -> None:
        """Start the program with the next poll, however short ago it was started."""
        self._tried_ns = None

    def end_program(self) -> None:
        """Have the program brake and end."""
        self._number = self._number % LARGEST + 1
        self.client.send(message(self._number, 0.0, self.run, [0.0] * 6))

    def take_longest_round_trip(self) -> float:
        """The longest time from a message to its answer (s) since the last call."""
        longest, self._longest = self._longest, 0.0
        return longest

    def notes(self) -> list[str]:
        """What the controller is and has set, for people."""
        values, version = self.client.values, self.client.version or ()
        said = f"controller's software {'.'.join(map(str, version[:3]))}, {self.client.rate_hz:g} Hz"
        payload, tcp = values.get("payload"), values.get("tcp_offset")
        said += "" if payload is None else f"; payload {payload:g} kg"
        said += "" if tcp is None else f"; tool at {', '.join(f'{each * 1e3:.1f}' for each in tcp[:3])} mm"
        return [f"{said}; {slowed(values) or 'full speed scaling'}"]

    def close(self) -> None:
        """Hang up."""
        self.client.close()
        self._errands.close()

    def _runs(self) -> bool:
        return self.run != 0 and int(self.client.values.get(RUN, 0)) == self.run

    def _unanswered(self, now_ns: int) -> float:
        """Since when the oldest message is under way that was not answered (s)."""
        oldest = next(iter(self._sent_ns.values()), None)
        return 0.0 if oldest is None else (now_ns - oldest) * 1e-9

    def _note_answer(self, now_ns: int) -> None:
        values = self.client.values
        heard = int(values[HEARD])
        if not self._runs() or heard == self._heard:
            return
        self._heard, self._heard_ns = heard, now_ns
        sent_ns = self._sent_ns.get(heard)
        if sent_ns is None:
            return
        self.round_trip = (now_ns - sent_ns) * 1e-9
        self._longest = max(self._longest, self.round_trip)
        for number in list(self._sent_ns):
            del self._sent_ns[number]
            if number == heard:
                break

    def _is_old_try(self, now_ns: int) -> bool:
        return self._tried_ns is None or now_ns - self._tried_ns > to_ns(TRY_AGAIN)

    def _start(self, now_ns: int) -> None:
        self._tried_ns = now_ns
        self.run = secrets.randbelow(LARGEST - 1) + 1
        self._sent_ns.clear()
        self._heard_ns = now_ns
        step = 1.0 / self.client.rate_hz
        self._errands.start_program(program_text(self._settings, self.run, step, self._acceleration))
