"""Files on the side that find no place: the task is finished, the result is written, and what is missing is said."""

import json
import shlex
import subprocess
import sys

import pytest

from farhand.common.link.ports import free_ports
from farhand.common.recording.reader import read_run
from farhand.programs.command_line import NetemWords, OperatorWords, RecordWords, RobotWords

pytestmark = pytest.mark.realtime


@pytest.fixture
def cramped():
    """Starts a program by its words for which the disk is full at so many KiB of every file."""
    running = []

    def start(words, size):
        command = shlex.join([sys.executable, "-m", "farhand", *map(str, words.words())])
        running.append(
            subprocess.Popen(
                ["bash", "-c", f"ulimit -f {size}; exec {command}"], stderr=subprocess.PIPE, text=True
            )
        )
        return running[-1]

    yield start
    for program in running:
        program.kill()
        program.communicate()


def test_a_recording_and_a_log_that_cannot_grow_cost_neither_the_task_nor_the_results(
    started, cramped, scenario, endpoint, tmp_path
):
    down = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    report = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    log, record, result, stats = (tmp_path / name for name in ("log.csv", "run.mcap", "o.json", "n.json"))
    netem = cramped(
        NetemWords(listen_operator=endpoint, listen_robot=down, log=str(log), stats=str(stats)), 12
    )
    started(RobotWords(scenario=scenario, robot="r", connect=(down,)))
    operator = started(
        OperatorWords(scenario=scenario, robot="r", connect=(endpoint,), report=report, result=str(result))
    )
    recorder = cramped(RecordWords(connect=report, robot="r", out=str(record)), 72)
    assert operator.wait() == 0
    assert json.loads(result.read_text())["finished"]
    said = recorder.communicate(timeout=20)[1]
    assert recorder.returncode == 1, said
    assert "Traceback" not in said
    assert "ticks are missing: it cannot be written: File too large" in said
    whole = read_run(record)
    assert not whole.complete
    assert len(whole.ticks) > 5
    netem.terminate()
    said = netem.communicate(timeout=20)[1]
    assert netem.returncode == 0, said
    assert "Traceback" not in said
    assert json.loads(stats.read_text())["version"] == 1
    assert "rows are missing: it cannot be written: File too large" in said
    assert log.stat().st_size <= 12 * 1024
