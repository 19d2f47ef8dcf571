"""The watchdog as a state machine: whatever arrives in whatever order, its promises hold."""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from common.messages import Echo, VelocityCommand
from common.scenario import SafetySettings
from robot_side.plan import ZERO
from robot_side.watchdog import Watchdog

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
        self.refused = 0

    def command(self, session, mode, *, age_ms=50, seq=None, velocity=(0.1, 0.0, 0.0), plan=(), echo=True):
        if seq is None:
            self.seqs[session] += 1
            seq = self.seqs[session]
        stamp = Echo(ROBOT, 1, self.now - age_ms * MS, 0) if echo else None
        return VelocityCommand(
            source="op",
            session=session,
            seq=seq,
            t_sent_ns=1,
            echo=stamp,
            mode=mode,
            velocity=velocity,
            plan=plan,
        )

    def give(self, command):
        before = (self.watchdog.mode, self.watchdog.velocity(self.now), self.watchdog.refused.total())
        obeyed = self.watchdog.receive(command, self.now)
        after = self.watchdog.refused.total()
        assert after == before[2] + (not obeyed)
        if not obeyed:
            assert self.watchdog.mode == before[0]
            assert self.watchdog.velocity(self.now) == before[1]
        if obeyed and command.mode in ("run", "hold", "acknowledge"):
            self.last_good = self.now
        return obeyed

    @rule(session=sessions, velocity=velocities, age_ms=st.integers(-100, 1500), n=st.integers(0, 12))
    def run(self, session, velocity, age_ms, n):
        holder, latched = self.watchdog.lease.holder, self.watchdog.latched
        obeyed = self.give(
            self.command(session, "run", velocity=velocity, age_ms=age_ms, plan=(velocity,) * n)
        )
        good = (
            holder in (0, session)
            and not latched
            and 0 <= age_ms <= LIMITS.max_age * 1000
            and max(map(abs, velocity)) <= LIMITS.max_speed
        )
        assert obeyed == good
        if obeyed:
            assert self.watchdog.mode == "run"
            assert self.watchdog.velocity(self.now) == velocity
            assert self.watchdog.lease.holder == session

    @rule(session=sessions, fault=st.sampled_from(["echo", "replay"]))
    def bad_run(self, session, fault):
        if fault == "echo":
            assert not self.give(self.command(session, "run", echo=False))
        elif self.watchdog.lease.holder == session:
            assert not self.give(self.command(session, "run", seq=self.seqs[session]))

    @rule(session=sessions)
    def hold(self, session):
        before = self.watchdog.mode
        if self.give(self.command(session, "hold")):
            assert self.watchdog.mode == (before if before in LATCHED else "hold")
            assert self.watchdog.velocity(self.now) == ZERO

    @rule(session=sessions, age_ms=st.sampled_from([20, 1400]))
    def acknowledge(self, session, age_ms):
        holder = self.watchdog.lease.holder
        obeyed = self.give(self.command(session, "acknowledge", age_ms=age_ms))
        assert obeyed == (holder in (0, session) and age_ms <= 1000)
        if obeyed:
            assert self.watchdog.mode == "hold"
            assert self.watchdog.velocity(self.now) == ZERO

    @rule(session=sessions)
    def release(self, session):
        holder = self.watchdog.lease.holder
        assert self.give(self.command(session, "release")) == (holder == session)
        if holder == session:
            assert self.watchdog.lease.holder == 0
            assert self.watchdog.velocity(self.now) == ZERO

    @rule(session=sessions, seq=st.integers(0, 5))
    def estop(self, session, seq):
        assert self.give(self.command(session, "estop", seq=seq, echo=False))
        assert self.watchdog.mode == "estop"

    @rule()
    def fault(self):
        self.watchdog.fault("it broke", self.now)
        assert self.watchdog.mode == "stopped"

    @rule(ms=st.integers(1, 700))
    def pass_time(self, ms):
        latched, mode = self.watchdog.latched, self.watchdog.mode
        self.now += ms * MS
        self.watchdog.tick(self.now)
        if latched:
            assert self.watchdog.mode == mode

    @precondition(lambda self: self.watchdog.mode == "run")
    @rule()
    def silence(self):
        self.now = self.last_good + 301 * MS if self.now < self.last_good + 301 * MS else self.now
        self.watchdog.tick(self.now)
        assert self.watchdog.mode in ("hold", "stopped")

    @invariant()
    def a_latch_stands_still(self):
        if self.watchdog.mode in LATCHED:
            assert self.watchdog.velocity(self.now) == ZERO

    @invariant()
    def silence_ends_motion(self):
        if self.watchdog.velocity(self.now) != ZERO:
            assert self.now - self.last_good <= LIMITS.stop_timeout * 1e9
            assert max(map(abs, self.watchdog.velocity(self.now))) <= LIMITS.max_speed

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
