"""Where nothing commands an arm any more, its controller must have it stand: else the trial of faults fails."""

import dataclasses
from types import SimpleNamespace

import pytest

from farhand.trials.faults.breakages import Breakage, breakages
from farhand.trials.faults.judgement import Outcome
from farhand.trials.faults.runner import run_fault

WELL = Outcome(None, 0.1, 0.2, 0.06, 20, 0, 0, {}, 0.1, ())


def judged(stood, breakage, has_controller=True):
    outcome = dataclasses.replace(WELL, arm_stood=stood)
    rig = SimpleNamespace(has_controller=has_controller, measure=lambda _: (outcome, None))
    return run_fault(rig, breakage).unsafe


@pytest.mark.parametrize(("stood", "safe"), [(0.174, True), (0.4, False), (None, False)])
def test_an_arm_that_moves_on_is_unsafe(stood, safe):
    assert (judged(stood, Breakage(print, arm_stands=True)) == ()) is safe
    assert judged(stood, Breakage(print)) == ()  # somebody commands it still
    assert judged(stood, Breakage(print, arm_stands=True), has_controller=False) == ()


def test_it_is_asked_for_where_the_robots_program_is_frozen_or_gone():
    asked = {name for name, breakage in breakages().items() if breakage.arm_stands}
    assert asked == {"robot frozen for 5 s", "robot killed, restarted", "robot ended, restarted"}
