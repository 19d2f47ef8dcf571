"""The emulator killed and started again under a running operator and robot."""

import signal
import threading

import pytest

from farhand.common.link.ports import free_ports
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.demo.children import Children
from farhand.demo.report_reader import ReportReader
from farhand.programs.command_line import NetemWords, OperatorWords, RobotWords
from farhand.runs.run import Run
from farhand.runs.run_folder import write_scenario
from farhand.runs.scenario import load_scenario, replace_setting

PATIENCE = 30.0
PAUSE = threading.Event()


@pytest.mark.realtime
def test_both_sides_come_back_and_the_robot_was_stopped_meanwhile(tmp_path):
    clock = SystemClock()
    scenario = load_scenario("point-obstacle")
    # far targets, so that the task outlasts the test
    scenario = replace_setting(scenario, "targets", [[6.0, 0.0, 0.6], [0.6, 0.0, 0.6]] * 3)
    settings = str(write_scenario(Run.over(scenario), tmp_path))
    operator_side, robot_side, report = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))
    netem = NetemWords(listen_operator=operator_side, listen_robot=robot_side, network="constant:20")
    robot = RobotWords(scenario=settings, connect=(robot_side,), robot="point")
    operator = OperatorWords(scenario=settings, connect=(operator_side,), robot="point", report=report)
    children = Children(tmp_path, clock)
    reader = None

    def wait_for(condition, what):
        deadline_ns = clock.now_ns() + to_ns(PATIENCE)
        while clock.now_ns() < deadline_ns:
            for seen in (arrived.report for arrived in reader.read()):
                if condition(seen):
                    return seen
            assert set(children.ended()) <= {"netem"}, children.ended()
            PAUSE.wait(0.02)
        raise AssertionError(f"no {what} within {PATIENCE} s")

    try:
        for words in (netem, robot, operator):
            children.start(words.COMMAND, words.words())
        reader = ReportReader(report, "point", clock)
        before = wait_for(lambda r: r.safety == "run" and r.mode == "run", "motion")
        assert before.stops == 0
        children.running["netem"].send_signal(signal.SIGKILL)
        children.running["netem"].wait()
        # longer than the watchdog's stop_timeout, on the operator's clock
        wait_for(lambda r: r.state_age > scenario.safety.stop_timeout + 0.5, "silence")
        children.start("netem", netem.words())
        back = wait_for(lambda r: r.state_age < 0.2, "state")
        assert back.stops == 1
        again = wait_for(lambda r: r.safety == "run" and r.mode == "run", "motion after the restart")
        assert again.stops == 1
        assert again.session == before.session
        print(f"driving again {(again.t_sent_ns - back.t_sent_ns) * 1e-9:.2f} s after the first state")
    finally:
        if reader is not None:
            reader.close()
        children.stop()
