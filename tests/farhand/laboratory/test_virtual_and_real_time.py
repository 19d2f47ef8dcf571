"""Whole tasks in virtual time: safe and finished over the networks that Farhand promises to stand."""

import json

import msgspec
import pytest

from farhand.cli import run
from farhand.common.errors import SpecError
from farhand.laboratory.simulation import simulate
from farhand.netem.settings import NetworkSettings
from farhand.runs.scenario import load_scenario, replace_settings
from tests.examples import also

NETWORKS = ["none", "lund-stockholm", "gaussian:50,20", "constant:200", "uniform:50,200", "5g-urban"]
POINT = load_scenario("point-obstacle")


def check(summary, scenario):
    assert summary.safe, summary
    assert summary.finished, summary
    assert summary.min_clearance >= scenario.controller.d_min
    assert summary.stops == 0
    assert summary.targets_reached == summary.targets == 3
    assert summary.why == ""
    assert summary.exit_code == 0


@pytest.mark.parametrize("seed", [0, also(1)])
@pytest.mark.parametrize("network", NETWORKS)
def test_the_adaptive_margin_is_safe_and_finishes(network, seed):
    check(simulate(POINT, uplink=network, downlink=network, seed=seed).summary, POINT)


@pytest.mark.parametrize("network", ["5g-urban", "constant:200"])
def test_the_ur5_finishes_and_does_not_stand_still_in_a_margin(network):
    scenario = load_scenario("ur5-obstacle")
    summary = simulate(scenario, uplink=network, downlink=network, seed=0, time_limit=60.0).summary
    check(summary, scenario)
    assert summary.min_arm_clearance > 0


def test_the_round_trip_is_the_network_and_the_computing():
    summary = simulate(POINT, uplink="constant:60", downlink="constant:40", computing_time=0.015).summary
    assert summary.rtt_mean == pytest.approx(0.115, abs=1e-6)
    assert summary.rtt_std == pytest.approx(0.0, abs=1e-6)


def test_without_margin_prediction_and_guard_it_says_honestly_how_it_went():
    bare = {"margin.kind": "none", "operator.predictor": "none", "guard.on": False}
    scenario = replace_settings(POINT, bare)
    summary = simulate(scenario, uplink="constant:200", downlink="constant:200").summary
    assert summary.min_clearance < 0.01
    assert not summary.safe
    assert summary.exit_code == 1


def test_a_task_that_does_not_finish_says_why():
    summary = simulate(POINT, uplink="none", downlink="none", time_limit=3.0).summary
    assert not summary.finished
    assert "not finished within 3 s: 0 of 3 targets reached" in summary.why
    summary = simulate(POINT, uplink="loss:100%", downlink="none", time_limit=3.0).summary
    assert "0 of 3" in summary.why
    assert summary.exit_code == 1


def test_an_outage_stops_the_robot_and_the_task_goes_on_afterwards():
    network = "constant:20 outage:every(15s,4s)"
    summary = simulate(POINT, uplink=network, downlink=network).summary
    assert summary.safe
    assert summary.finished
    assert summary.stops >= 1


def test_a_task_leaves_no_world_of_the_physics_engine_behind():
    import pybullet

    before = sum(map(pybullet.isConnected, range(64)))
    simulate(load_scenario("ur5-obstacle"), uplink="none", downlink="none", time_limit=0.2)
    with pytest.raises(SpecError):
        simulate(load_scenario("ur5-obstacle"), uplink="constant:", downlink="none")
    assert sum(map(pybullet.isConnected, range(64))) == before


def test_simulate_writes_summary_figure_and_recording(tmp_path, capsys):
    out = tmp_path / "run"
    arguments = ["simulate", "--scenario", "point-obstacle", "--network", "constant:50", "--seed", "4"]
    assert run([*arguments, "--out", str(out), "--json"]) == 0
    captured = capsys.readouterr()
    printed = json.loads(captured.out.splitlines()[-1])
    assert printed == json.loads((out / "summary.json").read_text())
    for key in ("safe", "finished", "min_clearance", "duration", "rtt_mean", "rtt_std"):
        assert key in printed
    for key in ("interventions", "stops", "refused"):
        assert isinstance(printed[key], int)
    assert printed["seed"] == 4
    assert "SAFE" in captured.err
    for name in ("run.png", "run.pdf", "run.mcap", "scenario.toml"):
        assert (out / name).stat().st_size > 500
    again = load_scenario(str(out / "scenario.toml"))
    assert (again.network.uplink, again.network.downlink) == ("constant:50", "constant:50")
    assert msgspec.structs.replace(again, network=NetworkSettings()) == load_scenario("point-obstacle")
