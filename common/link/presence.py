"""How a program shows that it is there (a liveliness token) and says what it is (an `about` queryable)."""

import importlib.metadata
import json
import platform
import threading
from collections.abc import Callable

import zenoh

from farhand.common.messages.base import SCHEMA
from farhand.common.messages.keys import about_key, alive_key
from farhand.common.timing.clock import utc_seconds
from farhand.common.timing.realtime import request_realtime
from farhand.common.trust.certificate import Member


def may_run_realtime() -> bool:
    """Whether this process may have SCHED_FIFO; asked for in a thread that ends at once."""
    granted: list[bool] = []
    thread = threading.Thread(target=lambda: granted.append(request_realtime()))
    thread.start()
    thread.join()
    return bool(granted and granted[0])


def about(role: str, certificate: Member | None = None) -> dict[str, object]:
    """What a program is: versions, schema, rights, its time of day, its certificate's name and days left."""
    try:
        version = importlib.metadata.version("farhand")
    except importlib.metadata.PackageNotFoundError:
        version = "unknown"
    facts: dict[str, object] = {
        "role": role,
        "farhand": version,
        "schema": SCHEMA,
        "zenoh": importlib.metadata.version("eclipse-zenoh"),
        "python": platform.python_version(),
        "realtime": may_run_realtime(),
    }
    return facts | _now(certificate)


def answerer(role: str, certificate: Member | None = None) -> Callable[[], bytes]:
    """Gives the answer to the `about` question as JSON, with the days left at the time of asking."""
    facts = about(role, certificate)
    return lambda: json.dumps(facts | _now(certificate)).encode()


def _now(certificate: Member | None) -> dict[str, object]:
    found: dict[str, object] = {"utc": round(utc_seconds())}
    if certificate is not None:
        found["certificate"] = certificate.name
        found["days_left"] = round(certificate.days_left, 2)
    return found


class Presence:
    """Keeps a program's token and answers its `about` question until the session closes.

    Args:
        session: open.
        robot: the robot's name; `netem` for the emulator.
        role: operator, robot or netem.
        certificate: the program's own, with TLS.
    """

    def __init__(
        self, session: zenoh.Session, robot: str, role: str, certificate: Member | None = None
    ) -> None:
        key, answer = about_key(robot, role), answerer(role, certificate)

        def reply(query: zenoh.Query) -> None:
            query.reply(key, answer())

        self.token = session.liveliness().declare_token(alive_key(robot, role))
        self.queryable = session.declare_queryable(key, reply)
