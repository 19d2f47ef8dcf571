"""The same seed gives the same bytes: in one process, in fresh ones, and over recorded traces."""

import subprocess
import sys
from pathlib import Path

import pytest

from farhand.laboratory.campaigns.jobs import task_seed
from farhand.laboratory.campaigns.tasks import make_task
from farhand.laboratory.simulation import simulate
from farhand.runs.scenario import load_scenario
from tests.netem.recordings.samples.places import SAMPLES, measured

ROOT = Path(__file__).resolve().parents[3]
PROFILES = ("5g-urban", "starlink", "wifi-moving", "bursty-loss-20", "outages")

SPEC = "uniform:50,200 loss:10% duplicate:1%"


def digests() -> list[str]:
    return [
        simulate(kind, uplink=SPEC, downlink=SPEC, seed=7, time_limit=3.0, digest=True).digest
        for kind in ("point-obstacle", "box-obstacle")
    ]


def test_a_fresh_process_gives_the_same_bytes():
    fresh = subprocess.run(
        [sys.executable, "-c", f"from {__name__} import digests; print(*digests())"],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
    )
    assert fresh.returncode == 0, fresh.stderr
    assert fresh.stdout.split() == digests()
    assert len(set(digests())) == 2


def test_the_digest_sees_the_seed():
    scenario = load_scenario("point-obstacle")
    digests = {
        simulate(
            scenario, uplink="uniform:50,200", downlink="none", seed=seed, time_limit=3.0, digest=True
        ).digest
        for seed in (1, 1, 2)
    }
    assert len(digests) == 2


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_traces_replay_the_same_and_the_robot_stays_safe(path):
    check_twice(f"trace:{path}")


@pytest.mark.parametrize(
    "file", ["cicv5g_urban_n78_100hz.txt", "cicv5g_urban_n78_20hz.txt", "starlink_oneway_10ms_slots.txt"]
)
def test_measured_traces_replay_the_same_and_the_robot_stays_safe(file):
    check_twice(f"trace:{measured(file)}")


@pytest.mark.parametrize("spec", PROFILES)
def test_the_robot_stays_safe_and_arrives_over_built_in_networks(spec):
    """That these give the same bytes is kept in golden/runs.toml."""
    check_once(spec)


def check_twice(spec: str) -> None:
    assert check_once(spec) == check_once(spec)


def check_once(spec: str) -> str:
    scenario = load_scenario("point-obstacle")
    result = simulate(scenario, uplink=spec, downlink=spec, seed=5, time_limit=120.0, digest=True)
    assert result.summary.safe
    assert result.summary.finished, result.summary.why
    return result.digest


def test_the_kinematic_box_and_the_rigid_body_agree_on_success():
    # Bullet's integrator stops the box 2 ms times its speed earlier: about 1 mm, which decides only without margin.
    outcomes = set()
    for index, margin in ((2, "none"), (0, "adaptive"), (10, "none")):
        point, box = (
            simulate(
                make_task(1, index, robot, margin),
                uplink="constant:200",
                downlink="constant:200",
                seed=task_seed("table1", 1, index),
                time_limit=300.0,
            ).summary
            for robot in ("point", "box")
        )
        assert point.finished
        assert box.finished
        outcomes.add(point.safe)
        if point.safe != box.safe:
            assert margin == "none"
            assert abs(point.min_clearance - point.d_min) < 2e-3
            assert abs(box.min_clearance - box.d_min) < 2e-3
    assert outcomes == {True, False}  # the tasks tell something
