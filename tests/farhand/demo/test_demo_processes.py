"""The demo with real processes over real Zenoh: how it ends, however it ends, nothing is left behind."""

import json
import signal
import statistics

import psutil
import pytest

from farhand.common.messages.codec import Decoder
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.common.recording.reader import read_run
from farhand.common.timing.clock import utc_seconds
from farhand.laboratory.simulation import simulate
from farhand.runs.scenario import load_scenario
from farhand.testing import Program, short_task
from tests.examples import also

pytestmark = pytest.mark.realtime
ENDS_WITHIN = 2.0
LOADED = 4.0  # what a loaded machine may add to it
BALL = """
[[obstacles]]
id = "ball"
position = [0.35, 0.0, 0.43]
radius = 0.05
"""
TOO_LATE = 0.01
UPLINK, DOWNLINK, SEED = "gaussian:60,10", "constant:60", 5


class Demo(Program):
    """A running demo, its words as they come, and all its processes."""

    def __init__(self, folder):
        self.folder = folder / "run"
        self.scenario = short_task(folder, more=BALL)
        networks = "--uplink", UPLINK, "--downlink", DOWNLINK
        super().__init__(
            "demo", "--scenario", self.scenario, "--json", *networks, "--seed", SEED, "--out", self.folder
        )  # fmt: skip

    def wait_until_it_drives(self):
        """Until the live status says `run`; returns the three programs by name."""
        self.wait_for_line(lambda line: "run" in line.split() or "filter intervening" in line)
        children = {}
        for child in psutil.Process(self.process.pid).children(recursive=True):
            arguments = child.cmdline()
            children[arguments[arguments.index("farhand") + 1]] = child
        assert set(children) == {"operator", "netem", "robot", "record"}
        return children

    def end(self):
        """Exit code, and the summary or None."""
        code = self.wait()
        return code, json.loads(self.output.splitlines()[-1]) if self.output.strip() else None

    def close(self):
        """Nothing that this test started stays, whatever went wrong."""
        try:
            processes = psutil.Process(self.process.pid).children(recursive=True)
        except psutil.NoSuchProcess:
            processes = []
        super().close()
        for process in processes:
            if process.is_running():
                process.kill()


@pytest.fixture
def demo(tmp_path):
    started = Demo(tmp_path)
    yield started
    started.close()


def gone(children, timeout=ENDS_WITHIN + LOADED):
    _, alive = psutil.wait_procs(list(children.values()), timeout)
    return not alive


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """One demo from beginning to end, for all that is asked of it."""
    started = Demo(tmp_path_factory.mktemp("demo"))
    children = started.wait_until_it_drives()
    code, summary = started.end()
    assert gone(children)
    yield started, code, summary
    started.close()


def test_end_to_end(finished):
    demo, code, summary = finished
    assert code == 0, demo.said
    assert summary["safe"]
    assert summary["finished"]
    assert summary["min_clearance"] >= 0.010
    assert summary["duration"] > 1.0
    assert 0.11 < summary["rtt_mean"] < 0.2
    assert summary["seed"] == SEED
    assert summary["interventions"] > 0
    assert (summary["stops"], summary["real_time"], summary["why"]) == (0, True, "")
    assert summary == json.loads((demo.folder / "summary.json").read_text())
    for name in ("run.png", "run.pdf", "run.mcap", "report.html", "netem.json"):
        assert (demo.folder / name).stat().st_size > 500


def test_virtual_time_agrees_with_real_time(finished):
    """Clearance within 5 mm, round trips within 3 ms: the same draws, in processes and in one.

    Virtual time has no wire, so the tick is charged what computing and wire took in the median. Quartiles, since
    a loaded machine holds up a message now and then; one that holds up many is granted twice what it was late by on
    the way down, and nothing is compared where that would hide the draws.
    """
    demo, _, summary = finished
    run = read_run(demo.folder / "run.mcap")
    assert run.complete
    late = 2.0 * lateness(run)
    if late > TOO_LATE:
        pytest.skip(f"the machine was late by {late * 1e3:.0f} ms: too much to see the draws")
    decode = Decoder(ControlReport).decode_or_raise
    real = quartiles(decode(tick.report) for tick in run.ticks)
    scenario = load_scenario(str(demo.scenario))

    def virtual(computing_time):
        found = simulate(
            scenario,
            uplink=UPLINK,
            downlink=DOWNLINK,
            seed=SEED,
            computing_time=computing_time,
            keep_reports=True,
        )
        return quartiles(found.reports), found.summary

    overhead = real[1] - virtual(0.0)[0][1]
    assert 0.0 < overhead < 0.05
    found, virtual_summary = virtual(overhead)
    assert found == pytest.approx(real, abs=max(0.003, late))
    assert found[2] - found[0] > 0.006  # or the draws would say nothing
    assert virtual_summary.finished
    assert virtual_summary.min_clearance == pytest.approx(
        summary["min_clearance"], abs=0.005 + max(scenario.controller.speed_limit) * max(0.0, late - 0.003)
    )
    assert virtual_summary.duration == pytest.approx(summary["duration"], rel=0.1)


def lateness(run):
    """By how much nine of ten states came later at most than the quickest; the downlink delays all alike (s)."""
    decode = Decoder(RobotState).decode_or_raise
    ways = sorted(
        arrived_ns - decode(payload).t_sent_ns
        for tick in run.ticks
        for key, arrived_ns, payload in tick.packets
        if key.endswith("/state")
    )
    return (ways[int(0.9 * len(ways))] - ways[0]) * 1e-9


def quartiles(reports):
    return statistics.quantiles([r.rtt for r in reports if r.rtt is not None])


@pytest.mark.parametrize("number", [signal.SIGINT, also(signal.SIGTERM), also(signal.SIGHUP)])
def test_ctrl_c_and_its_like_end_all_three(demo, number):
    children = demo.wait_until_it_drives()
    demo.signal(number)
    assert gone(children)
    code, summary = demo.end()
    assert code == 1
    assert summary["why"] == "interrupted"
    assert not summary["finished"]
    assert (demo.folder / "summary.json").exists()
    assert not [line for line in demo.said if "the record program" in line]
    assert read_run(demo.folder / "run.mcap").complete


@pytest.mark.parametrize("victim", [also("operator"), also("netem"), "robot"])
def test_the_death_of_one_ends_all_and_is_told(demo, victim):
    children = demo.wait_until_it_drives()
    children[victim].kill()
    assert gone(children)
    code, summary = demo.end()
    assert code == 1
    assert summary["why"] == f"the {victim} program was killed by signal 9"
    assert not summary["finished"]


@pytest.mark.long
def test_the_death_of_the_recorder_costs_the_last_second_of_the_recording_alone(demo):
    children = demo.wait_until_it_drives()
    file = demo.folder / "run.mcap"
    before = file.stat().st_size
    demo.wait_for_line(lambda _: file.stat().st_size > before)  # it is up with the operator's program
    killed = utc_seconds()
    children["record"].kill()
    code, summary = demo.end()
    assert (code, summary["finished"], summary["why"]) == (0, True, "")
    assert any("the record program was killed by signal 9" in line for line in demo.said)
    run = read_run(demo.folder / "run.mcap")
    assert run.cut_off
    assert killed - (run.ticks[-1].now_ns + run.info.epoch_ns) * 1e-9 < 1.0
    assert run.whole_ticks == len(run.ticks) > 5


def test_the_death_of_the_demo_itself_leaves_nothing(demo):
    children = demo.wait_until_it_drives()
    demo.signal(signal.SIGKILL)
    assert gone(children)
