"""A robot that says that it is stopped: it stays so until it says nothing more and that was acknowledged."""

from farhand.robot_side.safety.settings import SafetySettings
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.testing import command, echo_of, state
from farhand.testing.messages import ROBOT_SESSION

MS = 1_000_000


def seen(at_ns):
    """The echo of a state that was sent then."""
    return echo_of(state(0, t_sent_ns=at_ns))


def test_only_an_acknowledgement_of_a_state_from_after_the_block_leads_on():
    watchdog = Watchdog(SafetySettings(), ROBOT_SESSION)
    assert watchdog.receive(command(0, "acknowledge", echo=seen(10 * MS)), 20 * MS)
    assert watchdog.receive(command(1, "run", echo=seen(20 * MS)), 30 * MS)
    assert watchdog.mode == "run"
    for at in range(40, 100, 2):
        watchdog.block("protective stop: look why", at * MS)
    assert (watchdog.mode, watchdog.reason, watchdog.stops) == ("stopped", "protective stop: look why", 1)
    assert watchdog.twist(98 * MS).linear == (0.0, 0.0, 0.0)
    assert not watchdog.receive(command(2, "run", echo=seen(90 * MS)), 100 * MS)
    # sent while it still was blocked, although after the stop began
    assert not watchdog.receive(command(3, "acknowledge", echo=seen(96 * MS)), 110 * MS)
    assert watchdog.refused["unseen-stop"] == 1
    assert watchdog.receive(command(4, "acknowledge", echo=seen(102 * MS)), 120 * MS)
    assert watchdog.receive(command(5, "run", echo=seen(104 * MS)), 130 * MS)
    assert watchdog.mode == "run"


def test_an_emergency_stop_is_not_made_less_by_a_block():
    watchdog = Watchdog(SafetySettings(), ROBOT_SESSION)
    watchdog.receive(command(0, "estop"), 10 * MS)
    for at in (20, 22):
        watchdog.block("power off", at * MS)
    assert (watchdog.mode, watchdog.reason) == ("estop", "emergency stop by operator; power off")
