"""The emulated controller in virtual time, and Farhand's program on it: what the deadline promises, it keeps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.robot_side.arm.model import model
from farhand.robot_side.ur.program import ENDED, HEARD, INPUTS, RUN, fastest_joint, message, program_text
from farhand.robot_side.ur.settings import UrSettings
from farhand.ur_emulator.controller import Controller, Runtime, SafetyMode
from farhand.ur_emulator.functions import WAITS, Functions
from farhand.ur_emulator.program import Program
from farhand.ur_emulator.sockets import ProgramSockets
from farhand.ur_emulator.urscript import translate
from farhand.ur_emulator.wire import Wire

ARM = model("ur5")
RUNS, OTHER = 11, 12
JOINT = 5  # turns the flange alone, and no link into another


class Bench:
    """A controller, its cycles counted by the test, with Farhand's program on it."""

    def __init__(self, rate_hz=500.0, settings=None):
        self.said = []
        self.controller = Controller(ARM, ARM.home, rate_hz, (5, 12, 0, 1), self.said.append)
        self.settings = settings or UrSettings()
        self.number = 0
        self.start()

    def start(self, text=None):
        step = self.controller.step_time
        text = text or program_text(self.settings, RUNS, step, float(ARM.max_acceleration.max()))
        functions = Functions(self.controller, ProgramSockets(Wire())).table()
        translation = translate(text, WAITS, functions)
        assert not translation.unknown
        program = Program(translation, functions)
        if translation.secondary:
            self.controller.run_secondary(program)
        else:
            self.controller.start_program(program)

    def tell(self, speed, run=RUNS, deadline=None):
        self.number += 1
        qd = [0.0] * 6
        qd[JOINT] = speed
        deadline = self.settings.deadline_time if deadline is None else deadline
        values = dict(zip(INPUTS, message(self.number, deadline, run, qd), strict=True))
        self.controller.registers.inputs.update(values)
        self.controller.heard(INPUTS)

    def cycles(self, seconds, speed=None):
        for _ in range(round(seconds * self.controller.rate_hz)):
            if speed is not None:
                self.tell(speed)
            self.controller.cycle()

    def stands_after(self):
        """How long it moves on from now (s)."""
        begin = self.controller.now
        while self.controller.moves or self.controller.motion.qd.any():
            self.controller.cycle()
            assert self.controller.now - begin < 5.0
        return self.controller.now - begin

    def out(self, name):
        return self.controller.registers.outputs[name]


@pytest.fixture
def bench():
    made = Bench()
    yield made
    made.controller.close()


def test_a_speed_that_is_told_is_driven_and_every_message_is_answered(bench):
    bench.cycles(0.3, 0.5)
    assert bench.controller.physics.qd[JOINT] == pytest.approx(0.5, abs=1e-3)
    assert bench.out(HEARD) == bench.number
    assert bench.out(RUN) == RUNS


@pytest.mark.parametrize("rate_hz", [125.0, 500.0])
@pytest.mark.parametrize("share", [0.05, 1.0])
def test_silence_ends_in_an_ordinary_stop_within_a_fifth_of_a_second_from_any_speed(rate_hz, share):
    bench = Bench(rate_hz)
    fastest = fastest_joint(bench.settings, bench.controller.step_time, float(ARM.max_acceleration.min()))
    bench.cycles(0.4, share * fastest)
    assert bench.controller.physics.qd[JOINT] == pytest.approx(share * fastest, rel=1e-3)
    assert 0.06 < bench.stands_after() <= 0.2
    assert bench.controller.safety_mode == SafetyMode.NORMAL
    assert bench.out(ENDED) == 1
    bench.cycles(0.05)
    assert bench.controller.runtime == Runtime.STOPPED
    bench.controller.close()


def test_it_ends_when_it_is_told_to_and_says_so(bench):
    bench.cycles(0.2, 0.5)
    bench.tell(0.5, deadline=0.0)
    assert bench.stands_after() < 0.2
    assert bench.out(ENDED) == 2


def test_the_watchdog_ends_in_a_protective_stop():
    bench = Bench(settings=UrSettings(deadline="watchdog"))
    bench.cycles(0.3, 0.5)
    assert bench.stands_after() <= 0.2
    assert bench.controller.safety_mode == SafetyMode.PROTECTIVE_STOP
    assert bench.controller.runtime == Runtime.PAUSED
    bench.controller.close()


@settings(max_examples=12, deadline=None)
@given(
    pauses=st.lists(st.floats(0.002, 0.1), min_size=1, max_size=25),
    runs=st.lists(st.sampled_from([RUNS, RUNS, RUNS, OTHER]), min_size=25, max_size=25),
)
def test_whatever_comes_when_the_arm_stands_soon_after_the_last_message_of_its_own_run(pauses, runs):
    bench = Bench()
    last = bench.controller.now
    for pause, run in zip(pauses, runs, strict=False):
        bench.tell(0.5, run)
        if run == RUNS:
            last = bench.controller.now
        bench.cycles(pause)
        if bench.controller.now - last > 0.2 + bench.controller.step_time:
            assert not bench.controller.moves
    bench.cycles(0.2)
    assert not bench.controller.moves
    bench.cycles(0.9)  # what comes first may come as late
    for _ in range(20):  # it has ended: no message moves anything any more
        bench.tell(0.5)
        bench.cycles(0.02)
        assert bench.controller.runtime != Runtime.PLAYING
        assert not bench.controller.moves
    bench.controller.close()


def test_a_protective_stop_pauses_the_program_and_is_not_unlocked_before_five_seconds(bench):
    bench.cycles(0.2, 0.5)
    bench.controller.protective_stop("test")
    assert bench.stands_after() < 0.1
    assert bench.controller.runtime == Runtime.PAUSED
    assert bench.controller.unlock_protective_stop().startswith("Cannot unlock")
    bench.cycles(5.1)
    assert bench.controller.unlock_protective_stop() == "Protective stop releasing"
    bench.cycles(0.5)
    assert bench.controller.runtime == Runtime.PAUSED
    assert not bench.controller.moves


def test_a_paused_program_that_is_played_does_not_drive_on_at_the_old_speed(bench):
    bench.cycles(0.2, 0.5)
    bench.controller.pause()
    bench.cycles(1.0, 0.0)  # Farhand goes on to tell it to stand
    before = bench.controller.physics.q.copy()
    bench.controller.play()
    bench.cycles(0.5, 0.0)
    assert np.abs(bench.controller.physics.q - before).max() < 1e-3


def test_half_the_speed_scaling_is_half_the_speed(bench):
    bench.controller.set_slider(0.5)
    bench.cycles(0.5, 0.4)
    assert bench.controller.physics.qd[JOINT] == pytest.approx(0.2, abs=1e-3)


def test_payload_and_tool_are_set_by_the_program():
    wanted = UrSettings(payload=1.25, payload_cog=(0.0, 0.01, 0.05), tcp=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0))
    bench = Bench(settings=wanted)
    bench.cycles(0.02, 0.0)
    controller = bench.controller
    assert (controller.payload, controller.payload_cog) == (1.25, [0.0, 0.01, 0.05])
    assert controller.tcp == list(wanted.tcp)
    controller.close()
