"""`farhand robots`: who is there, by liveliness tokens, and who holds control or waits for it, by states."""

import json
import threading
from collections.abc import Sequence
from dataclasses import dataclass

import zenoh
from rich.table import Table

from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import PREFIX, robot_of, state_key
from farhand.common.messages.state import RobotState
from farhand.common.messages.twins import Twins
from farhand.common.process.console import page, whole
from farhand.common.process.security import Access, secure, tool_place
from farhand.common.process.signals import say
from farhand.common.timing.clock import SystemClock, to_ns, to_seconds
from farhand.operator_side.supervision import holder_name
from farhand.runs.freshness import Freshness, freshness

MEET_TIME = 3.0
LOOK_TIME = 2.0
OVERLAP = 0.5


def list_robots(connect: Sequence[str], tls: str, as_json: bool, router: bool = False) -> int:
    """Print who is there; returns 0, or 1 if nobody answered or two robots have one name."""
    folder = secure(Access(connect=tuple(connect), tls=tls), lambda line: say("robots", line))
    extra = folder.settings(tool_place(folder)) if folder else ()
    session = open_session(connect, mode="client" if router else "peer", extra=extra)
    try:
        if not meet(session, MEET_TIME):
            say("robots", f"{', '.join(connect)}: nobody answers; `farhand doctor` says why")
            return 1
        present = alive(session)
        states = _look(session, [name for name, roles in present.items() if "robot" in roles])
    finally:
        session.close()  # type: ignore[no-untyped-call]
    rows = [robot_row(name, present[name], states.get(name)) for name in sorted(present) if name != "netem"]
    emulated = "netem" in present
    code = 1 if any(row["there"] == "several" for row in rows) else 0
    if as_json:
        print(json.dumps({"robots": rows, "netem": emulated}))
        return code
    columns = ("robot", "there", "operator", "mode", "control", "waiting")
    table = Table(title_justify="left")
    for column in columns:
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(*(str(row[column]) for column in columns))
    console = page()
    console.print(whole(table, console) if rows else "no robots")
    if emulated:
        print("a network emulator (farhand netem) is between here and the robots")
    return code


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


@dataclass(frozen=True, slots=True)
class Seen:
    """One robot's newest state.

    Attributes:
        state: the state.
        age: since it came, at the end of the look (s).
        twins: whether several robots of that name send states.
    """

    state: RobotState
    age: float
    twins: bool = False


def _look(session: zenoh.Session, names: Sequence[str]) -> dict[str, Seen]:
    """What robots say for a while; the age of each is counted here."""
    clock, lock, pause = SystemClock(), threading.Lock(), threading.Event()
    newest: dict[str, tuple[RobotState, int]] = {}
    twins: dict[str, Twins] = {name: Twins(to_ns(OVERLAP)) for name in names}
    decoder = Decoder(RobotState)

    def receive(sample: zenoh.Sample) -> None:
        now_ns = clock.now_ns()
        with lock:
            state, name = decoder.decode(sample.payload.to_bytes()), robot_of(str(sample.key_expr))
            if state is not None and name in twins:
                newest[name] = state, now_ns
                twins[name].note(state.session, now_ns)

    subscribers = [session.declare_subscriber(state_key(name), receive) for name in names]
    if subscribers:
        pause.wait(LOOK_TIME)
    now_ns = clock.now_ns()
    with lock:
        return {
            name: Seen(state, to_seconds(now_ns - at_ns), twins[name].there(now_ns))
            for name, (state, at_ns) in newest.items()
        }


def robot_row(name: str, roles: set[str], seen: Seen | None) -> dict[str, object]:
    """What is said of one robot; nothing that a state said is told as so when the state is old."""
    there = "yes" if "robot" in roles else "no"
    live = seen is not None and freshness(seen.age) is Freshness.LIVE
    state = seen.state if seen is not None and live else None
    if seen is None:
        mode = "no state" if "robot" in roles else "gone, or never there"
    elif state is None:
        mode = f"no state for {seen.age:.1f} s (was {seen.state.mode})"
    else:
        mode = f"{state.mode}: {state.reason}"
    if seen is not None and seen.twins:
        there, mode = "several", f"several robots have this name; {mode}"
    control = "?" if state is None else "free"
    if state is not None and state.holder:
        control = holder_name(state)
    return {
        "robot": name,
        "there": there,
        # An operator on our own side of an emulator shows no token here, but in what the robot says of it.
        "operator": "yes" if "operator" in roles or (state is not None and state.holder) else "none seen",
        "mode": mode,
        "control": control,
        "waiting": ", ".join(name for _, name in state.waiting) if state is not None else "",
        "state_age": None if seen is None else round(seen.age, 3),
    }
