"""A scenario's section `network` is obeyed by every command that emulates one; the command line goes before it."""

import pytest

from farhand.cli import run
from farhand.common.errors import InputError
from farhand.laboratory.campaigns.sweep import Sweep
from farhand.laboratory.simulation import simulate
from farhand.pytest_plugin import Farhand, Settings
from farhand.runs.scenario import load_scenario
from farhand.trials.kernel.compare import NETWORKS, networks_of

SCENARIO = """
name = "short"
start = [0.0, 0.0, 0.5]
targets = [[0.7, 0.0, 0.5]]
[robot]
kind = "point"
[network]
uplink = "constant:7"
"""
EDGES = {
    "demo": "farhand.demo.demo.run_demo",
    "simulate": "farhand.laboratory.simulate_run.run_simulation",
    "summarise": "farhand.runs.conclude.run_summarise",
}


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(SCENARIO)
    return path


@pytest.fixture
def runs(monkeypatch):
    """What the commands would have run."""
    found = []

    def take(run, *_args, **_kwargs):
        found.append(run)
        return 0

    for place in EDGES.values():
        monkeypatch.setattr(place, take)
    return found


def words(command, scenario):
    return [command, *(["folder"] if command == "summarise" else []), "--scenario", str(scenario)]


@pytest.mark.parametrize("command", EDGES)
@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ([], "constant:7 / 5g-urban"),
        (["--set", "network.downlink=constant:8"], "constant:7 / constant:8"),
        (["--downlink", "none"], "constant:7 / none"),
        (["--uplink", "none"], "none / 5g-urban"),
        (["--network", "constant:9"], "constant:9"),
        (["--network", "none"], "none"),
    ],
)
def test_commands(command, options, expected, scenario, runs):
    assert run([*words(command, scenario), *options]) == 0
    assert str(runs[0].network) == expected


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            [],
            "network: the downlink is 5g-urban, the default, since only the other direction is said; --downlink none",
        ),
        (["--downlink", "none"], ""),
        (["--set", "network.downlink=none"], ""),
        (["--network", "none"], ""),
    ],
)
def test_the_direction_that_nobody_says_is_told_of(options, said, scenario, runs, capsys):
    assert run([*words("simulate", scenario), *options]) == 0
    told = capsys.readouterr().err
    assert said in told
    assert bool(said) == ("the default" in told)
    assert run([*words("simulate", "point-obstacle"), "--uplink", "none"]) == 0
    assert "the downlink is 5g-urban, the default" in capsys.readouterr().err
    assert run(words("simulate", "point-obstacle")) == 0
    assert "the default" not in capsys.readouterr().err


@pytest.mark.parametrize("command", EDGES)
def test_a_scenario_without_one_gets_the_commands_own(command, runs):
    assert run(words(command, "point-obstacle")) == 0
    assert str(runs[0].network) == "5g-urban"


@pytest.mark.parametrize("command", EDGES)
def test_a_bad_spec_names_key_and_file_in_one_line(command, scenario, runs, capsys):
    scenario.write_text(SCENARIO.replace("constant:7", "constant:"))
    assert run(words(command, scenario)) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    assert f"scenario {scenario}: network.uplink: " in said
    assert runs == []
    assert run([*words(command, scenario), "--network", "none"]) == 0


SWEEP = 'scenario = "short.toml"\n{}\n[grid]\n"controller.gamma" = [0.3]\n{}'


@pytest.mark.parametrize(
    ("head", "grid", "expected"),
    [
        ("", "", "constant:7 / none"),
        ('network = "constant:1"', "", "constant:1"),
        ('downlink = "constant:1"', "", "constant:7 / constant:1"),
        ("", 'network = ["constant:2"]', "constant:2"),
        ('uplink = "constant:1"', 'network = ["constant:2"]', "constant:1 / constant:2"),
        ("", '"network.uplink" = ["constant:3"]', "constant:3 / none"),
    ],
)
def test_sweeps(head, grid, expected, scenario, tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text(SWEEP.format(head, grid))
    assert [str(job.run.network) for job in Sweep(path).jobs] == [expected]


def test_a_sweep_over_a_bad_one_names_all_three(scenario, tmp_path):
    scenario.write_text(SCENARIO.replace("constant:7", "constant:"))
    path = tmp_path / "sweep.toml"
    path.write_text(SWEEP.format("", ""))
    with pytest.raises(InputError, match=r"^sweep .*sweep.toml: scenario .*short\.toml: network\.uplink: "):
        Sweep(path)


@pytest.mark.parametrize(
    ("marker", "expected"),
    [
        ({}, "constant:7 / none"),
        ({"network": "constant:1"}, "constant:1"),
        ({"downlink": "constant:1"}, "constant:7 / constant:1"),
        ({"uplink": "constant:1"}, "constant:1 / none"),
    ],
)
def test_the_plugin(marker, expected, scenario):
    result = Farhand(Settings(scenario=str(scenario), time_limit=0.3, **marker)).run()
    assert result.summary.network == expected


def test_the_function(scenario):
    found = simulate(load_scenario(str(scenario)), time_limit=0.3)
    assert found.summary.network == "constant:7 / none"
    assert found.network.uplink.spec == "constant:7"
    assert simulate(load_scenario(str(scenario)), uplink="none", time_limit=0.3).summary.network == "none"


def test_the_comparison_with_the_kernel(scenario):
    own, plain = load_scenario(str(scenario)), load_scenario("point-obstacle")
    assert list(map(str, networks_of(own, None, "x"))) == ["constant:7 / none"]
    assert list(map(str, networks_of(own, ["loss:1%"], "x"))) == ["loss:1%"]
    assert list(map(str, networks_of(plain, None, "x"))) == list(NETWORKS)
