"""A console changes the network at a real emulator: what is told is its answer, and nothing without one."""

import threading

import pytest

from farhand.common.errors import EndpointError
from farhand.common.link.ports import free_ports
from farhand.common.timing.clock import SystemClock
from farhand.programs.command_line import NetemWords
from farhand.programs.live_network import LiveNetwork

pytestmark = pytest.mark.realtime
PATIENCE = 15.0
pause = threading.Event()


def until(holds, what):
    for _ in range(round(PATIENCE / 0.02)):
        if holds():
            return
        pause.wait(0.02)
    raise AssertionError(f"not within {PATIENCE:g} s: {what}")


@pytest.fixture
def place():
    operator, robot, control = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))
    return {"listen_operator": operator, "listen_robot": robot, "control": control}


@pytest.fixture
def network(place):
    network = LiveNetwork(place["control"], "r", SystemClock().now_ns)
    yield network
    network.close()


def test_a_network_is_chosen_cut_and_gone_with_its_emulator(place, network, started):
    assert network.told() is None
    netem = started(NetemWords(**place, uplink="constant:50", downlink="none"))
    until(network.told, "the emulator answers")
    first = network.told()
    assert (first.name, first.outage, first.refused) == ("constant:50 / none", False, "")
    assert {"constant:50 / none", "5g-urban", "constant:200"} <= set(first.names)
    network.choose("5g-urban")
    until(lambda: network.told().name == "5g-urban", "it is changed")
    network.choose("nonsense")
    until(lambda: "nonsense" in network.told().refused, "it says why not")
    assert network.told().name == "5g-urban"
    network.choose("constant:50 / none")
    until(lambda: network.told().name == "constant:50 / none", "it is as at the start")
    assert not network.told().refused
    network.cut(1.0)
    until(lambda: network.told().outage, "it is cut")
    until(lambda: not network.told().outage, "it is back")
    netem.close()
    until(lambda: network.told() is None, "nobody answers")


def test_what_could_not_be_asked_for_in_time_is_not_done_later(place, network, started):
    network.choose("5g-urban")
    pause.wait(1.5)
    started(NetemWords(**place, uplink="none", downlink="none"))
    until(network.told, "the emulator answers")
    pause.wait(0.7)
    assert network.told().name == "none"


def test_a_robot_with_a_network_of_its_own_has_that_one_changed(place, network, started):
    started(NetemWords(**place, uplink="none", downlink="none", robot_network=("r=constant:20",)))
    until(lambda: network.told() and network.told().name == "constant:20", "its own is shown")
    network.choose("starlink")
    until(lambda: network.told().name == "starlink", "its own is changed")


def test_an_emulator_elsewhere_is_refused():
    with pytest.raises(EndpointError, match="this host only"):
        LiveNetwork("tcp/10.0.0.5:7449", "r", lambda: 0)
