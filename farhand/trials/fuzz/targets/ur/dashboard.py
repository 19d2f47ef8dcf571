"""The dashboard of the emulated controller."""

from collections.abc import Callable

from farhand.trials.fuzz.target import Target, check
from farhand.trials.fuzz.ur_bench import Input, controller
from farhand.ur_emulator.dashboard import DashboardHandler


def seeds() -> list[bytes]:
    """Its words."""
    words = (
        "robotmode\nsafetymode\nprogramState\nrunning\nis in remote control\nPolyscopeVersion\nget serial number\n"
        "power off\npower on\nbrake release\nunlock protective stop\nclose safety popup\nplay\npause\nstop\nquit\n"
    )
    return [words.encode(), *(word.encode() + b"\n" for word in words.split("\n") if word)]


def start() -> Callable[[bytes], None]:
    """See Target."""
    emulated = controller()
    fresh = dict(vars(emulated))

    def take(data: bytes) -> None:
        vars(emulated).update(fresh)
        connection = Input(data)
        DashboardHandler(connection, emulated, "20195500001", "UR5").poll(0.0)
        check(len(connection.sent) < 1_000_000, "an answer without bounds")
        check(emulated.program is None and not emulated.moves, "an arm moves without a program")

    return take


TARGET = Target(
    edge="the dashboard of the emulated UR controller",
    promise="nothing moves without a program",
    seeds=seeds,
    start=start,
    shape="text",
    longest=1024,
)
