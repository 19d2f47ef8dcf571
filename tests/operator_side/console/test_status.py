"""One pill, one sentence: each situation says what is the matter and what clears it."""

import msgspec
import pytest

from farhand.common.messages.intervention import Intervention
from farhand.operator_side.console.following import Shortfall
from farhand.operator_side.console.status import NOT_ENGAGED, Situation, lost, reasons, unheard
from farhand.testing import report, state

NEAR = Intervention(
    part="forearm", obstacle="ball", distance=0.031, limit=0.01, asked=0.2, done=0.05, what="slowed"
)
EVADES = msgspec.structs.replace(NEAR, part="tool", asked=0.0, done=0.2, what="evading")
SLOWED = report(
    desired=(0.2, 0.0, 0.0),
    filtered=(0.05, 0.0, 0.0),
    intervening=True,
    binding="ball",
    clearance=0.02,
    inflation=0.024,
)
WHY = msgspec.structs.replace(
    SLOWED, limit=0.01, margin_parts={"floor": 0.01, "innovation": 0.019, "spread": 0.004, "lag": 0.005}
)
BEGINS = report(desired=(0.2, 0.0, 0.0), filtered=(0.05, 0.0, 0.0))
BEGUN = Shortfall(0.0, 0.15, "m/s", lasting=False)
STANDS, CRAWLS = (Shortfall(done, 0.15, "m/s", lasting=True) for done in (0.0, 0.03))
ESTOP = state(mode="estop", reason="by o")
UNHEARD = report(mode="hold", stop_reason=NOT_ENGAGED)
CUT = state(
    mode="stopped", reason="no state from the controller", t_sent_ns=5_000_000_000, t_sample_ns=2_900_000_000
)
EDGE = state(held_by="the edge of its reach")
TURNED = msgspec.structs.replace(SLOWED, filtered=(0.15, 0.0, 0.13))


def situation(**more):
    return Situation(**{"report": report(), "state": state(), "report_age": 0.0, "state_age": 0.0} | more)


@pytest.mark.parametrize(
    ("now", "pill", "words"),
    [
        (situation(report=None), "link lost", "operator's program"),
        (situation(report_age=1.5), "link lost", "1.5 s"),
        (situation(state=None), "link lost", "Nothing has come"),
        (situation(state_age=2.0, driver="page 1"), "link lost", "2.0 s"),
        (situation(state=CUT, state_age=2.1), "link lost", "no news of the arm for 2.1 s (no state from"),
        (situation(state=CUT, state_age=2.8), "link lost", "No news from the robot for 2.8 s."),
        (situation(state=state(mode="estop", reason="emergency stop by the operator")), "e-stop", "by the operator"),
        (situation(state=state(mode="stopped", reason="fault: x")), "stopped", "fault: x"),
        (situation(report=report(stop_reason="anna holds control; waiting")), "taken", "anna"),
        (situation(), "ready", "Nobody drives"),
        (situation(driver="page 1"), "ready", "Hold a key"),
        (situation(driver="page 1", watches=True, asks="page 2"), "watching", "Page 1 drives, you watch."),
        (situation(driver="page 1", watches=True, you="page 6"), "watching", "Page 1 drives, you watch on page 6."),
        (situation(driver="page 1", asks="page 2"), "ready", "Page 2 asks for control."),
        (situation(driver="page 1", stopping=True), "e-stop", "not confirmed"),
        (situation(driver="page 1", was_lost=3.2), "ready", "Connected again after 3.2 s. Nothing is driven"),
        (situation(driver="page 1", watches=True, was_lost=3.2), "watching", "until page 1 presses anew."),
        (situation(driver="page 1", holds=True), "run", "As asked"),
        (situation(state=state(mode="stopped", reason="x", guard=EVADES)), "stopped", "guard takes the tool out"),
        (situation(state=state(mode="stopped", reason="x", guard=NEAR)), "stopped", "; its guard acts: slowed"),
        (situation(state=state(mode="stopped", reason="x", evades=True)), "stopped", "x; its guard may take it out"),
        (situation(driver="page 1", state=state(mode="hold", guard=EVADES)), "slowed", "Nobody drives it; the robot"),
        (situation(driver="page 1", state=state(mode="run", guard=EVADES)), "slowed", "The robot's guard acts: evad"),
        (situation(state=state(mode="estop", reason="x", guard=EVADES)), "e-stop", "Latched by the robot: x, on"),
        (situation(was_lost=3.2, state=state(mode="stopped", reason="x")), "stopped", "Connected again after 3.2 s. L"),
        (situation(was_lost=3.2, state=state(mode="estop", reason="by o")), "e-stop", "Connected again after 3.2 s. L"),
        (situation(driver="page 1", holds=True, state_age=0.6), "link lost", "what the robot does now is not known"),
        (situation(driver="page 1", frozen=1.5), "held", "nothing new for 1.5 s. Driving is locked"),
        (situation(driver="page 1", holds=True, report_age=0.6), "link lost", "from the operator's program"),
        (situation(driver="page 1", holds=True, report=UNHEARD), "held", "Let go"),
        (situation(driver="page 1", holds=True, report=UNHEARD, held_for=0.1), "run", "Pressed;"),
        (situation(driver="page 1", holds=True, state=state(guard=NEAR)), "slowed", "forearm 31 mm from ball"),
        (situation(driver="page 1", holds=True, report=SLOWED), "slowed", "margin 24"),
        (situation(driver="page 1", holds=True, state=state(guard=NEAR)), "slowed", "limit 10, by the robot's guard"),
        (situation(driver="page 1", holds=True, report=SLOWED, near=0.031), "slowed", "tool 31 mm from ball"),
        (situation(driver="page 1", holds=True, report=SLOWED, near=0.271), "slowed", ", the nearer the slower;"),
        (situation(driver="page 1", holds=True, report=SLOWED, near=0.03), "slowed", "from ball; margin 24."),
        (situation(driver="page 1", holds=True, report=SLOWED), "slowed", "Slowed by ball"),
        (situation(driver="page 1", holds=True, report=TURNED, near=0.05), "slowed", "Turned aside: tool 50 mm"),
        (situation(driver="page 1", holds=True, report=BEGINS), "run", "On the way to what was asked: 0.05"),
        (situation(driver="page 1", holds=True, short=BEGUN), "run", "On the way: the robot does 0.00 of 0.15 m/s"),
        (situation(driver="page 1", holds=True, short=STANDS), "held", "does not follow: not known yet why."),
        (situation(driver="page 1", holds=True, short=STANDS, state=EDGE), "held", "does not follow: the edge of its"),
        (situation(driver="page 1", holds=True, short=CRAWLS, state=EDGE), "slowed", "follows with 0.03 of 0.15"),
        (situation(driver="page 1", holds=True, report=WHY), "slowed", "limit 10, margin 24, of which network 9."),
        (situation(state=ESTOP, stopped_by="page 2", you="page 2"), "e-stop", "by o, on this page."),
        (situation(state=ESTOP, stopped_by="page 2", you="page 3"), "e-stop", "by o, on page 2."),
    ],
)  # fmt: skip
def test_the_first_reason_is_the_pill(now, pill, words):
    first = reasons(now)[0]
    assert first.pill == pill
    assert words in first.what
    assert bool(lost(now)) is (unheard(now) or now.frozen > 0)
    assert unheard(now) is (now.report is None or now.state is None or max(now.report_age, now.state_age) > 1)
    if now.watches and not now.was_lost:
        assert "Pages are numbered as they are opened" in first.clears
    if pill not in ("run", "ready", "watching"):
        assert first.clears


def test_all_that_is_the_matter_is_listed():
    now = situation(driver="page 1", holds=True, report=SLOWED, state=state(guard=NEAR))
    assert [reason.pill for reason in reasons(now)] == ["slowed", "slowed"]


def test_nothing_is_called_ready_while_the_link_is_lost_or_the_robot_stopped():
    for now in (
        situation(state_age=2.0, outage=True),
        situation(state=state(mode="stopped", reason="fault: x")),
    ):
        assert "ready" not in [reason.pill for reason in reasons(now)]
    assert "outage" in reasons(situation(state_age=2.0, outage=True))[0].clears
