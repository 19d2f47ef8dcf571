"""The watchdog as a state machine: whatever arrives in whatever order, its promises hold."""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from farhand.common.messages.base import ZERO, Echo
from farhand.robot_side.safety.settings import SafetySettings
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.testing import messages

ROBOT = 1234
MS = 1_000_000
LIMITS = SafetySettings()
LATCHED = ("stopped", "estop")
sessions = st.sampled_from([7, 8, 9])
velocities = st.tuples(*[st.floats(-3, 3)] * 3)


class WatchdogMachine(RuleBasedStateMachine):
    """A model that knows only the rules: who may, what is new, what is fresh."""

    def __init__(self):
        super().__init__()
        self.watchdog = Watchdog(LIMITS, ROBOT)
        self.now = 10_000 * MS
        self.seqs = {7: 0, 8: 0, 9: 0}
        self.last_good = None
        # The model of the lease: who has it, when it was last heard, who asked when, and since when all know.
        self.holder, self.heard, self.since = 0, 0, 0
        self.asked = {}
        self.mode, self.stopped = "hold", 0  # as after the last rule; when the latched stop began
        self.evades_until = 0  # until when the guard may move what silence stopped; 0: it may not any more
        self.stopped_by = {}  # when, by session, of the emergency stop that is latched
        self.comes = False  # what it would be moved out of the way of

    def command(self, session, mode, *, age_ms=50, seq=None, velocity=(0.1, 0.0, 0.0), echo=True, **fields):
        """The session's next command, built on a state that is `age_ms` old."""
        if seq is None:
            self.seqs[session] += 1
            seq = self.seqs[session]
        basis = Echo(ROBOT, 1, self.now - age_ms * MS, 0) if echo else None
        given = fields | {"session": session, "source": f"operator.{session}"}
        return messages.command(seq, mode, velocity=velocity, echo=basis, **given)

    def give(self, command):
        before = (self.watchdog.mode, self.watchdog.twist(self.now).linear, self.watchdog.refused.total())
        obeyed = self.watchdog.receive(command, self.now)
        after = self.watchdog.refused.total()
        assert after == before[2] + (not obeyed)
        if not obeyed:
            assert self.watchdog.mode == before[0]
            assert self.watchdog.twist(self.now).linear == before[1]
        if self.watchdog.twist(self.now).linear != before[1]:
            assert self.watchdog.twist(self.now).linear == ZERO or self.holder == command.session
        if obeyed and command.mode in ("run", "hold", "acknowledge"):
            self.last_good = self.now
        return obeyed

    def knows(self, age_ms):
        """Whether a command of that age is fresh, and built on a state that showed how the lease is."""
        return 0 <= age_ms <= LIMITS.max_age * 1000 and self.now - age_ms * MS >= self.since

    def take(self, session, lawful):
        """The model: a lawful command of a session takes the lease if it is free, and keeps it."""
        if self.holder in (0, session) and (lawful or self.holder):
            self.holder, self.heard = session, self.now
            self.asked.pop(session, None)
        return self.holder == session

    def waits(self, session):
        return session in self.asked and self.now - self.asked[session] <= 3000 * MS

    @rule(session=sessions, velocity=velocities, age_ms=st.integers(-100, 1500), n=st.integers(0, 12))
    def run(self, session, velocity, age_ms, n):
        latched = self.watchdog.latched
        mine = self.take(session, self.knows(age_ms))
        obeyed = self.give(
            self.command(session, "run", velocity=velocity, age_ms=age_ms, plan=(velocity,) * n)
        )
        good = mine and not latched and self.knows(age_ms) and max(map(abs, velocity)) <= LIMITS.max_speed
        assert obeyed == good
        if obeyed:
            assert self.watchdog.mode == "run"
            assert self.watchdog.twist(self.now).linear == velocity
            assert self.watchdog.lease.holder == session

    @rule(session=sessions, fault=st.sampled_from(["echo", "replay"]))
    def bad_run(self, session, fault):
        if fault == "echo":
            self.take(session, False)
            assert not self.give(self.command(session, "run", echo=False))
        elif self.watchdog.lease.holder == session:
            assert not self.give(self.command(session, "run", seq=self.seqs[session]))

    @rule(session=sessions)
    def hold(self, session):
        before = self.watchdog.mode
        mine = self.take(session, self.knows(50))
        assert self.give(self.command(session, "hold")) == mine
        if mine:
            assert self.watchdog.mode == (before if before in LATCHED else "hold")
            assert self.watchdog.twist(self.now).linear == ZERO

    @rule(session=sessions, age_ms=st.sampled_from([20, 1400]))
    def acknowledge(self, session, age_ms):
        asks, held = self.holder not in (0, session), self.watchdog.refused["held"]
        mine = self.take(session, self.knows(age_ms))
        seen = self.mode not in LATCHED or self.now - age_ms * MS >= self.stopped
        obeyed = self.give(self.command(session, "acknowledge", age_ms=age_ms))
        assert obeyed == (mine and self.knows(age_ms) and seen)
        if asks and age_ms <= 1000:
            self.asked[session] = self.now
            assert self.watchdog.refused["held"] == held + 1
        if obeyed:
            assert self.watchdog.mode == "hold"
            assert self.watchdog.twist(self.now).linear == ZERO

    @rule(session=sessions)
    def release(self, session):
        mine = self.holder == session
        if mine:
            self.holder, self.since = 0, self.now
        assert self.give(self.command(session, "release")) == mine
        if mine:
            assert self.watchdog.lease.end == "released"
            assert self.watchdog.twist(self.now).linear == ZERO

    @rule(session=sessions, successor=sessions, age_ms=st.sampled_from([0, 30, 1400]))
    def hand_over(self, session, successor, age_ms):
        latched = self.watchdog.latched
        mine = self.take(session, False)
        good = mine and self.waits(successor) and self.knows(age_ms)
        given = self.give(self.command(session, "release", age_ms=age_ms, successor=successor))
        assert given == good
        if good:
            self.asked.pop(successor)
            self.holder, self.heard, self.since = successor, self.now, self.now
            assert self.watchdog.lease.holder_name == f"operator.{successor}"
            assert self.watchdog.twist(self.now).linear == ZERO
            assert latched == self.watchdog.latched
            # Nobody else, the old holder included, moves the robot from here on.
            for other in {7, 8, 9} - {successor}:
                assert not self.give(self.command(other, "run", age_ms=0))

    @rule(session=sessions, seq=st.integers(0, 5))
    def estop(self, session, seq):
        assert self.give(self.command(session, "estop", seq=seq, echo=False))
        assert self.watchdog.mode == "estop"
        if session not in self.stopped_by:
            self.stopped, self.evades_until = self.now, 0
            assert self.watchdog.reason.startswith(f"emergency stop by operator.{session}")
        elif self.now - self.stopped_by[session] > 500 * MS:
            self.stopped = self.now
        self.stopped_by[session] = self.now
        if session == self.holder:
            self.seqs[session] = max(self.seqs[session], seq)

    @rule()
    def fault(self):
        estop, before = self.watchdog.mode == "estop", self.watchdog.reason
        self.watchdog.fault("it broke", self.now)
        assert self.watchdog.mode == ("estop" if estop else "stopped")
        assert "fault: it broke" in self.watchdog.reason
        self.stopped = self.now if self.watchdog.reason != before else self.stopped
        self.evades_until = 0

    @rule(ms=st.integers(1, 700))
    def pass_time(self, ms):
        latched, mode = self.watchdog.latched, self.watchdog.mode
        self.now += ms * MS
        self.tick()
        if latched:
            assert self.watchdog.mode == mode

    @precondition(lambda self: self.watchdog.mode == "run")
    @rule()
    def silence(self):
        self.now = self.last_good + 301 * MS if self.now < self.last_good + 301 * MS else self.now
        self.tick()
        assert self.watchdog.mode in ("hold", "stopped")

    def tick(self):
        latched = self.watchdog.latched
        self.watchdog.tick(self.now)
        if self.watchdog.latched and not latched:
            self.evades_until = self.now + LIMITS.evade_timeout * 1e9
        if self.holder and self.now - self.heard > LIMITS.lease_timeout * 1e9:
            self.holder, self.since = 0, self.now
            assert self.watchdog.lease.end == "silent"

    @rule(ms=st.sampled_from([2001, 3001, 10_001]))
    def everybody_falls_silent(self, ms):
        self.now += ms * MS
        self.tick()
        assert self.watchdog.lease.holder == 0

    @invariant()
    def remember_the_stop(self):
        if self.watchdog.mode != self.mode and self.watchdog.mode in LATCHED:
            self.stopped = self.now
        if self.watchdog.mode not in LATCHED:
            self.stopped_by = {}
        self.mode = self.watchdog.mode

    @invariant()
    def the_lease_is_who_the_model_says(self):
        lease = self.watchdog.lease
        assert lease.holder == self.holder
        assert lease.holder_name == (f"operator.{self.holder}" if self.holder else "")
        waiting = {session for session in self.asked if self.waits(session)}
        assert dict(lease.waiting(self.now)) == {session: f"operator.{session}" for session in waiting}
        assert self.holder not in waiting

    @invariant()
    def nobody_moves_it_when_nobody_has_control(self):
        if self.holder == 0:
            assert self.watchdog.twist(self.now).linear == ZERO

    @invariant()
    def a_latch_stands_still(self):
        if self.watchdog.mode in LATCHED:
            assert self.watchdog.twist(self.now).linear == ZERO

    @rule(comes=st.booleans())
    def something_comes_or_goes(self, comes):
        self.comes = comes

    @invariant()
    def only_silence_lets_the_guard_move_it(self):
        over = self.now >= self.evades_until and not (self.evades_until and self.comes)
        stands = self.watchdog.latched and over
        if stands:
            self.evades_until = 0
        assert self.watchdog.stands(self.now, lambda: self.comes) == stands

    @invariant()
    def silence_ends_motion(self):
        if self.watchdog.twist(self.now).linear != ZERO:
            assert self.now - self.last_good <= LIMITS.stop_timeout * 1e9
            assert max(map(abs, self.watchdog.twist(self.now).linear)) <= LIMITS.max_speed

    @invariant()
    def run_is_recent(self):
        if self.watchdog.mode == "run":
            assert self.now - self.last_good <= LIMITS.command_timeout * 1e9

    @invariant()
    def every_change_has_its_reason(self):
        assert self.watchdog.reason
        assert all(change.reason for change in self.watchdog.changes)


WatchdogMachine.TestCase.settings = settings(max_examples=150, stateful_step_count=40, deadline=None)
TestWatchdogMachine = WatchdogMachine.TestCase
