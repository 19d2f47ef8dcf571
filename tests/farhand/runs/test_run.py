"""A run is one thing: which network is in force, and that it travels."""

import pickle

import msgspec
import pytest

from farhand.common.errors import InputError, SpecError
from farhand.netem.settings import NetworkSettings
from farhand.netem.spec import parse_spec
from farhand.runs.run import Run, choose_network, read_choice
from farhand.runs.scenario import load_scenario, scenario_from_table

PLAIN = load_scenario("point-obstacle")


def scenario_over(uplink=None, downlink=None):
    return msgspec.structs.replace(PLAIN, network=NetworkSettings(uplink=uplink, downlink=downlink))


BOTH = scenario_over("constant:1", "constant:2")
UP = scenario_over(uplink="constant:1")


@pytest.mark.parametrize(
    ("scenario", "choice", "expected"),
    [
        (PLAIN, {}, "5g-urban"),
        (BOTH, {}, "constant:1 / constant:2"),
        (UP, {}, "constant:1 / 5g-urban"),
        (scenario_over("none", "none"), {}, "none"),  # said, not absent
        (BOTH, {"network": "constant:3"}, "constant:3"),
        (BOTH, {"network": "none"}, "none"),
        (BOTH, {"uplink": "constant:3"}, "constant:3 / constant:2"),
        (UP, {"downlink": "constant:3"}, "constant:1 / constant:3"),
        (UP, {"network": "constant:3", "downlink": "constant:4"}, "constant:3 / constant:4"),
        (PLAIN, {"network": "constant:3", "uplink": "none"}, "none / constant:3"),
    ],
)
def test_what_was_asked_goes_before_the_scenario_and_that_before_the_default(scenario, choice, expected):
    network = choose_network(scenario, read_choice(**choice), default="5g-urban")
    assert str(network) == expected
    for way in (network.uplink, network.downlink):
        assert way.spec == parse_spec(way.text)


def test_a_bad_spec_of_a_scenario_names_file_and_key():
    scenario = scenario_over(downlink="gaussian:50")
    with pytest.raises(
        SpecError, match=r"^scenario here\.toml: network\.downlink: network \"gaussian:50\": at"
    ):
        choose_network(scenario, where="here.toml")
    with pytest.raises(InputError, match=r"^scenario point-obstacle: network\.downlink: .*nope\.csv"):
        choose_network(scenario_over(downlink="trace:nope.csv"))
    assert str(choose_network(scenario, read_choice("constant:3"))) == "constant:3"


@pytest.mark.parametrize("text", ["", " ", "constant:", "trace:nope.csv"])
def test_a_bad_choice_is_refused(text):
    with pytest.raises(InputError):
        read_choice(uplink=text)


def test_a_run_travels_between_processes():
    network = choose_network(PLAIN, read_choice("5g-urban loss:1% camera[none]", downlink="uniform:50,200"))
    run = Run(scenario=PLAIN, network=network, seed=3, computing_time=(0.01, 0.02))
    assert pickle.loads(pickle.dumps(run)) == run


def test_a_run_over_specs():
    assert str(Run.over(BOTH).network) == "constant:1 / constant:2"
    run = Run.over(BOTH, "constant:3", downlink="loss:1%", seed=4)
    assert (str(run.network), run.seed, run.scenario) == ("constant:3 / loss:1%", 4, BOTH)
    with pytest.raises(SpecError):
        Run.over(PLAIN, "constant:")


def test_its_table_is_a_scenario_with_the_network_in_force():
    run = Run(scenario=BOTH, network=choose_network(BOTH, read_choice(uplink="loss:1%")))
    again = scenario_from_table(run.table(), "again")
    assert str(choose_network(again)) == "loss:1% / constant:2"


def test_a_bad_timeline_is_refused_before_the_run(tmp_path):
    (tmp_path / "t.toml").write_text("[[at]]\ntime = -1\n")
    network = choose_network(PLAIN)
    for timeline in (tmp_path / "t.toml", tmp_path / "absent.toml"):
        with pytest.raises(InputError, match="timeline"):
            Run(scenario=PLAIN, network=network, timeline=str(timeline)).check()
    Run(scenario=PLAIN, network=network).check()
