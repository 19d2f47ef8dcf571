"""tc-netem for real: in this kernel where it has sch_netem, else in user-mode Linux where that is installed."""

import json
import shutil
import subprocess
import sys

import msgspec
import pytest

from farhand.common.errors import InputError
from farhand.netem.spec import NONE
from farhand.programs.command_line import NetemWords
from farhand.runs.run import Network, Run, Way, choose_network, read_choice
from farhand.runs.scenario import load_scenario
from farhand.trials.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT, Hosts, why_not
from farhand.trials.kernel import user_mode_linux
from farhand.trials.kernel.compare import why_no_kernel
from farhand.trials.kernel.drive import drive

pytestmark = [
    pytest.mark.hosts,
    pytest.mark.slow,
    pytest.mark.skipif(bool(why_not()), reason=why_not() or "-"),
    pytest.mark.skipif(not shutil.which("tc"), reason="needs tc, of iproute2"),
]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    command = [sys.executable, "-m", "tests.netem.tc.tc_kernel_look"]
    here, there = why_no_kernel(), user_mode_linux.why_not()
    if here and there:
        pytest.skip(f"{here}; {there}")
    if here:
        folder = tmp_path_factory.mktemp("writable")
        code, out, errors = user_mode_linux.run_inside(command, folder, timeout=60)
    else:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        code, out, errors = done.returncode, done.stdout, done.stderr
    assert code == 0, errors
    return json.loads(out.splitlines()[-1])


def netem_on(shown, device):
    (queue,) = shown[device]
    return queue


def test_packets_are_delayed_by_what_was_asked(found):
    seen = found["uplink"]
    assert 0.050 <= seen["p50"] < 0.075, seen  # a busy machine only adds to it
    assert netem_on(found["running"], "to-robot")["options"]["delay"] == {
        "delay": 0.05,
        "jitter": 0,
        "correlation": 0,
    }


def test_packets_are_lost_at_about_the_rate_that_was_asked(found):
    assert 0.04 < found["uplink"]["lost"] < 0.17  # 400 packets, 10 %: four standard deviations
    assert found["downlink"]["lost"] == 0.0


def test_a_table_of_our_own_is_drawn_from_and_order_is_kept(found):
    seen = found["downlink"]
    assert seen["overtaken"] == 0.0
    # In order at 200 packets a second: each waits for the slowest before it, so above the log-normal's 40 ± 10.
    assert 0.043 < seen["mean"] < 0.080, seen
    assert seen["std"] > 0.004, seen


def test_what_was_left_behind_is_gone_and_so_is_the_emulation_at_the_end(found):
    assert "tc on to-robot: took away what an emulation that was killed had left there" in found["said"]
    assert "corrupt" not in netem_on(found["running"], "to-robot")["options"]
    assert found["uplink"]["corrupted"] == 0
    assert {d: netem_on(found["ended"], d)["kind"] for d in found["ended"]} == dict.fromkeys(
        ("to-robot", "to-operator"), "noqueue"
    )
    assert found["code"] == 0
    assert [each["dropped"] > 0 for each in found["counted"]] == [True, False]


def test_a_drive_over_messages_is_measured_on_any_kernel(tmp_path):
    scenario = load_scenario("point-obstacle")
    network = choose_network(scenario, read_choice("constant:30 loss:5%"))
    run = Run(scenario=scenario, network=network, seed=1, time_limit=5.0)
    found = drive(run, "message", tmp_path, packets=0)
    assert 0.060 <= found.rtt["p50"] <= found.rtt["p99"], found
    assert found.drawn == pytest.approx(0.030)
    assert 0.0 < found.lost < 0.2
    assert not found.finished
    bad = Network(uplink=Way("gausian:1,1", NONE), downlink=network.downlink)
    with pytest.raises(InputError, match=r"netem did not start: network .*gausian"):
        drive(msgspec.structs.replace(run, network=bad), "message", tmp_path, packets=0)


def test_without_net_admin_it_is_refused_in_one_line():
    hosts = Hosts()
    try:
        words = NetemWords(
            backend="tc",
            network="constant:10",
            insecure=True,
            listen_operator=f"tcp/{NETEM_FOR_OPERATOR}:7447",
            listen_robot=f"tcp/{NETEM_FOR_ROBOT}:7448",
        ).words()
        without = ["setpriv", "--bounding-set=-net_admin", "--inh-caps=-net_admin"]
        command = [*without, sys.executable, "-m", "farhand", *words]
        done = subprocess.run(
            hosts.command_on("netem", *command), capture_output=True, text=True, timeout=60, check=False
        )
    finally:
        hosts.close()
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == (
        "farhand: --backend tc: needs the capability NET_ADMIN: run as root, in a container with cap_add: [NET_ADMIN]"
    )
