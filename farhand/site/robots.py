"""`farhand robots`: who is there, by liveliness tokens, and who holds control or waits for it, by states."""

import json
import threading
from collections.abc import Sequence

import zenoh
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import PREFIX, robot_of, state_key
from farhand.common.messages.state import RobotState
from farhand.common.process.security import Access, secure, tool_place
from farhand.common.process.signals import say
from farhand.operator_side.supervision import holder_name

MEET_TIME = 3.0
STATE_TIME = 1.5


def list_robots(connect: Sequence[str], tls: str, as_json: bool, router: bool = False) -> int:
    """Print who is there; returns 0, or 1 if nobody answered."""
    folder = secure(Access(connect=tuple(connect), tls=tls), lambda line: say("robots", line))
    extra = folder.settings(tool_place(folder)) if folder else ()
    session = open_session(connect, mode="client" if router else "peer", extra=extra)
    try:
        if not meet(session, MEET_TIME):
            say("robots", f"{', '.join(connect)}: nobody answers; `farhand doctor` says why")
            return 1
        present = alive(session)
        states = _states(session, [name for name, roles in present.items() if "robot" in roles])
    finally:
        session.close()  # type: ignore[no-untyped-call]
    rows = [_row(name, present[name], states.get(name)) for name in sorted(present) if name != "netem"]
    emulated = "netem" in present
    if as_json:
        print(json.dumps({"robots": rows, "netem": emulated}))
        return 0
    columns = ("robot", "there", "operator", "mode", "control", "waiting")
    table = Table(*columns, title_justify="left")
    for row in rows:
        table.add_row(*(escape(str(row[column])) for column in columns))
    Console().print(table if rows else "no robots")
    if emulated:
        print("an emulator is on the way")
    return 0


def meet(session: zenoh.Session, timeout: float) -> bool:
    """Wait until anybody is connected to the session; whether that happened in time (s)."""
    met = threading.Event()

    def change(event: zenoh.TransportEvent) -> None:
        if event.kind == zenoh.SampleKind.PUT:
            met.set()

    listener = session.info.declare_transport_events_listener(change, history=True)
    try:
        return met.wait(timeout)
    finally:
        listener.undeclare()  # type: ignore[no-untyped-call]


def alive(session: zenoh.Session, timeout: float = 2.0) -> dict[str, set[str]]:
    """Roles that are there, by robot; the emulator is the role and the robot `netem`."""
    present: dict[str, set[str]] = {}
    for reply in session.liveliness().get(f"{PREFIX}/*/alive/*", timeout=timeout):
        if reply.ok is not None:
            key = str(reply.ok.key_expr)
            present.setdefault(robot_of(key), set()).add(key.rpartition("/")[2])
    return present


def _states(session: zenoh.Session, names: Sequence[str]) -> dict[str, RobotState]:
    """One state of each robot, as far as they come in time."""
    found: dict[str, RobotState] = {}
    every = threading.Event()
    decoder = Decoder(RobotState)

    def receive(sample: zenoh.Sample) -> None:
        state = decoder.decode(sample.payload.to_bytes())
        if state is not None:
            found[robot_of(str(sample.key_expr))] = state
        if len(found) == len(names):
            every.set()

    subscribers = [session.declare_subscriber(state_key(name), receive) for name in names]
    if subscribers:
        every.wait(STATE_TIME)
    return dict(found)


def _row(name: str, roles: set[str], state: RobotState | None) -> dict[str, object]:
    control = "?" if state is None else "free"
    if state is not None and state.holder:
        control = holder_name(state)
    return {
        "robot": name,
        "there": "yes" if "robot" in roles else "no",
        # An operator on our own side of an emulator shows no token here, but in what the robot says of it.
        "operator": "yes" if "operator" in roles or (state is not None and state.holder) else "none seen",
        "mode": f"{state.mode}: {state.reason}" if state is not None else "no state",
        "control": control,
        "waiting": ", ".join(name for _, name in state.waiting) if state is not None else "",
    }
