"""Emulator, check and robot as programs, and what ends a drive: the arm stands in time, waits, and drives on."""

import signal

import pytest

from farhand.cli import run
from farhand.common.link.ports import free_ports
from farhand.trials.ur.faults import FAULTS, strike
from farhand.trials.ur.hand import Hand
from farhand.trials.ur.rig import SPEED, Rig

pytestmark = [pytest.mark.realtime, pytest.mark.slow]
ADDRESS = "127.0.0.31"


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    made = Rig(tmp_path_factory.mktemp("ur"), ADDRESS, driven=False)
    yield made
    made.close()


def test_nothing_is_in_the_way_and_the_loop_is_measured(rig):
    assert rig.farhand("ur", "check", "--host", ADDRESS, "--scenario", "ur5-obstacle") == 0
    said = rig.said("ur")
    assert "nothing is in the way" in said
    assert "round trip" in said
    assert "the controller lets every joint go" in said


def fault(name):
    return next(each for each in FAULTS if each.name == name)


def test_the_deadline_is_said_at_the_start_and_who_drives_must_acknowledge(rig):
    rig.start_robot()
    rig.hand = Hand(rig.endpoint, "ur", SPEED)
    said = rig.said("robot")
    assert "deadline: the controller's own program, by an ordinary stop: measured 0.06" in said
    assert "500 Hz; payload 0 kg" in said
    rig.wait(lambda: rig.mode() == "stopped", "the robot's state")
    assert rig.reason() == "the robot's program has just started: acknowledge to drive"
    before = rig.joints()
    rig.pause(0.5)
    assert rig.joints() == pytest.approx(before, abs=1e-4)
    rig.drive()


@pytest.mark.parametrize("name", ["robot program: kill -9", "cable out for 2 s"])
def test_the_arm_stands_in_time_waits_for_an_acknowledgement_and_drives_on(rig, name):
    outcome = strike(rig, fault(name))
    assert outcome.good, outcome


def test_a_hung_program_is_not_waited_for(rig):
    rig.drive()
    rig.signal(signal.SIGSTOP)
    rig.wait_for_stand()
    stood = float(rig.fault("standstill").split()[0])
    rig.programs["robot"].send_signal(signal.SIGCONT)
    assert 0.06 < stood <= 0.2
    rig.wait(lambda: rig.mode() == "stopped", "a stop")
    rig.drive()


def test_obstacles_come_and_go_while_it_drives_but_not_onto_the_arm(rig, capsys):
    at = ("--robot", "ur", "--connect", rig.endpoint)
    rig.drive()
    stops = rig.hand.state.stops
    here = ",".join(f"{x:.3f}" for x in rig.hand.state.position)
    assert run(["scene", "add", "--id", "bump", "--at", here, "--size", "0.2", *at]) == 1
    said = capsys.readouterr().err
    assert "_link is " in said
    assert "mm inside obstacle 'bump'; 10 mm are kept" in said
    assert (
        run(
            [
                "scene",
                "add",
                "--id",
                "post",
                "--shape",
                "box",
                "--at",
                "-0.6,0,0.3",
                "--size",
                "0.1,0.1,0.3",
                *at,
            ]
        )
        == 0
    )
    assert "scene revision 1, 2 obstacles: ball, post" in capsys.readouterr().out
    assert run(["scene", "remove", "post", *at]) == 0
    rig.wait(lambda: "scene: revision 2 by " in rig.said("robot"), "the robot's line")
    rig.wait(rig.moves, "the arm to drive on")
    assert rig.hand.state.stops == stops


def test_a_second_program_is_refused_in_one_line(rig):
    assert (
        rig.farhand(
            "robot", "--robot", "other", "--host", ADDRESS, "--listen", f"tcp/127.0.0.1:{free_ports(1)[0]}"
        )
        == 2
    )
    assert "another client is in control" in rig.said("robot")
    rig.drive()
