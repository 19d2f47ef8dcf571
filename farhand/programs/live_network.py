"""The emulator's live control for a console: asked in a thread of its own, so that no page waits for it."""

import queue
import threading
from collections.abc import Callable
from typing import Any

from farhand.common.errors import InputError
from farhand.common.link.requests import Asker
from farhand.common.timing.clock import to_ns
from farhand.netem.control import KEY, control_endpoint
from farhand.netem.models.profiles import PROFILES
from farhand.operator_side.console.network import NetworkTold

LOOK_EVERY = 0.5
ANSWERS_WITHIN = 1.0
"""An emulator that has not answered for so long can not be changed (s)."""
OLD_NS = to_ns(1.0)
"""A change that could not be asked for within this time is not asked for later."""
OFFERED = ("none", "constant:200", *PROFILES)
_Requests = list[dict[str, object]]


class LiveNetwork:
    """Args:
    endpoint: of the emulator's live control, on this host.
    robot: whose network it is; changed is its own, where it has one, else the common one.
    now_ns: the clock.

    Raises:
        EndpointError: the endpoint is not on this host.
    """

    def __init__(self, endpoint: str, robot: str, now_ns: Callable[[], int]) -> None:
        self._robot, self._now_ns = robot, now_ns
        self._asker = Asker(control_endpoint(endpoint), KEY)
        self._nobody = f"no emulator answers at {endpoint}"
        self._changes: queue.Queue[tuple[int, _Requests]] = queue.Queue(1)
        self._told: NetworkTold | None = None
        self._start: tuple[str, str] | None = None
        self._own = self._refused = ""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="live-network", daemon=True)
        self._thread.start()

    def told(self) -> NetworkTold | None:
        """The newest of what the emulator said; None: it does not answer."""
        return self._told

    def choose(self, name: str) -> None:
        """Have the network of that name, one of those that are offered."""
        up, down = self._start if self._start is not None and name == _named(*self._start) else (name, name)
        self._put(
            [
                {"do": "set", "direction": "uplink", "spec": up},
                {"do": "set", "direction": "downlink", "spec": down},
            ]
        )

    def cut(self, seconds: float) -> None:
        """Have no network for so long."""
        self._put([{"do": "outage", "length": seconds}])

    def close(self) -> None:
        """Ask no more."""
        self._closing.set()
        self._thread.join(2.0 * ANSWERS_WITHIN)
        self._asker.close()

    def _put(self, requests: _Requests) -> None:
        try:
            self._changes.put_nowait((self._now_ns(), requests))
        except queue.Full:
            self._refused = "the emulator is still busy with the last change"

    def _run(self) -> None:
        while not self._closing.is_set():
            try:
                asked_ns, requests = self._changes.get(timeout=LOOK_EVERY)
            except queue.Empty:
                pass
            else:
                self._change(asked_ns, requests)
            self._look()

    def _change(self, asked_ns: int, requests: _Requests) -> None:
        self._refused = ""
        try:
            for request in requests:
                if self._now_ns() - asked_ns > OLD_NS:
                    raise InputError("the emulator was not there in time; nothing was changed")
                self._ask(request | ({"robot": self._own} if self._own else {}))
        except InputError as error:
            self._refused = str(error)[:200]

    def _look(self) -> None:
        try:
            found = self._ask({"do": "show"})
        except InputError:
            self._told = None
            return
        directions = [found["statistics"][name] for name in ("uplink", "downlink")]
        own = [each["robot_specs"].get(self._robot) for each in directions]
        self._own = self._robot if any(own) else ""
        up, down = (mine or each["spec"] for mine, each in zip(own, directions, strict=True))
        self._start = self._start or (up, down)
        names = dict.fromkeys((_named(*self._start), *OFFERED))
        self._told = NetworkTold(tuple(names), up, down, found["outage_left"] > 0.0, self._refused)

    def _ask(self, request: dict[str, object]) -> dict[str, Any]:
        return self._asker.ask(request, self._nobody, ANSWERS_WITHIN, ANSWERS_WITHIN)


def _named(up: str, down: str) -> str:
    return up if up == down else f"{up} / {down}"
