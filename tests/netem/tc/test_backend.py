import json
import os
import shutil
import subprocess
import sys

import msgspec
import numpy as np
import pytest

from farhand.common.errors import InputError, SpecError
from farhand.common.result_file import write_result
from farhand.netem.impairments.base import ImpairmentContext
from farhand.netem.measure.result import NetemResult
from farhand.netem.models.profiles import PROFILES
from farhand.netem.settings import NetemSettings
from farhand.netem.spec import parse_spec
from farhand.netem.tc.backend import Device, KernelEmulation, kernel_emulation, set_commands
from farhand.netem.tc.host import HANDLE, claim, find_device, refusal
from farhand.netem.tc.tables import SIZE, Table, model_table, table_of
from farhand.netem.tc.words import KernelNetwork, kernel_network

KIND_UNKNOWN = "Error: Specified qdisc kind is unknown.\n"
NOT_PERMITTED = "RTNETLINK answers: Operation not permitted\n"


def addresses():
    return {"eth0": ["172.20.0.2", "fe80::1%eth0"], "eth1": ["172.21.0.2"]}


@pytest.fixture(autouse=True)
def host(monkeypatch):
    """Two devices; of the same name in tests that run at the same time, they are not the same."""
    monkeypatch.setattr("farhand.netem.tc.backend.find_device", lambda e, o: find_device(e, o, addresses))
    monkeypatch.setattr("farhand.netem.tc.backend.claim", lambda device: claim(f"{device}-{os.getpid()}"))


def words(text: str) -> str:
    arguments = kernel_network(parse_spec(text), "uplink").arguments
    assert arguments[:2] == ("limit", "10000")
    return " ".join(arguments[2:])


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ("constant:200", "delay 200ms"),
        ("constant:0.5", "delay 0.5ms"),
        ("uniform:50,200", "delay 125ms 75ms"),
        ("uniform:50,50", "delay 50ms"),
        ("gaussian:50,20", "delay 50ms 20ms distribution farhand"),
        ("gaussian:50,0", "delay 50ms"),
        ("normal:50,20", "delay 50ms 20ms distribution farhand"),
        ("loss:1%", "loss random 1%"),
        ("loss:gilbert(1%,10%)", "loss gemodel 1% 10% 100% 0%"),
        ("loss:state(1%,20%,10%,30%,0.5%)", "loss state 1% 20% 10% 30% 0.5%"),
        ("duplicate:1%", "duplicate 1%"),
        ("corrupt:0.1%", "corrupt 0.1%"),
        ("rate:2mbit", "rate 2000000bit"),
        ("slot:20", "slot 20ms 20ms"),
        ("slot:20,30,4", "slot 20ms 30ms packets 4"),
        ("slot:20,30,4,64kB", "slot 20ms 30ms packets 4 bytes 64000"),
        ("constant:10 reorder:gap(5,50%)", "delay 10ms reorder 50% gap 5"),
        ("gaussian:50,20 loss:1%", "loss random 1% delay 50ms 20ms distribution farhand"),
    ],
)
def test_words_of_a_spec_become_those_of_tc(spec, expected):
    assert words(spec) == expected


@pytest.mark.parametrize(
    "spec",
    [
        "outage:every(30s,2s)",
        "tcp-like",
        "trace:delays.csv",
        "rate:2mbit,64kB",
        "rate:7bit",
        "constant:5min",
        "camera[loss:5%]",
        "5g-urban",
        "bursty-loss-5 loss:1%",
        "reorder:gap(5)",
        "lognormal:50,20,25%",
        "uniform:50,200,25%",
        "loss:1%,25%",
        "corrupt:0.1%,10%",
        "constant:10 reorder:gap(5,50%,25%)",
        "loss:trace(delays.csv)",
        "slot:normal(20,5)",
    ],
)
def test_what_tc_has_not_is_refused_and_never_left_out(spec):
    with pytest.raises(SpecError, match="--backend tc") as caught:
        kernel_network(parse_spec(spec), "uplink")
    assert "\n" not in str(caught.value)


def test_none_needs_no_queue_at_all():
    assert kernel_network(parse_spec("none"), "uplink") == KernelNetwork()
    assert set_commands(Device("eth0", KernelNetwork())) == []


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ("gaussian:50,20 reorder:in-order", "delay 50ms 20ms distribution farhand rate 100gbit"),
        (
            "gaussian:50,20 rate:2mbit reorder:in-order",
            "rate 2000000bit delay 50ms 20ms distribution farhand",
        ),
        ("loss:1% reorder:in-order", "loss random 1%"),
    ],
)
def test_order_is_kept_by_a_rate_where_delays_could_change_it(spec, expected):
    assert words(spec) == expected


def drawn(table: Table) -> np.ndarray:
    """Delays (s) as the kernel computes them from the table."""
    return (table.mean_ns + table.jitter_ns * np.array(table.entries) / 8192) * 1e-9


def test_a_table_holds_the_distribution_to_its_ends():
    wanted = np.quantile(np.random.default_rng(1).gamma(2.0, 0.01, 100_000), (np.arange(SIZE) + 0.5) / SIZE)
    table = table_of(wanted)
    assert len(table.entries) == SIZE
    assert max(map(abs, table.entries)) < 2**15
    np.testing.assert_allclose(drawn(table), wanted, atol=(wanted.max() - wanted.min()) / 60_000)


@pytest.mark.parametrize("kind", ["gaussian", "pareto", "paretonormal", "lognormal"])
def test_a_table_is_the_distribution_that_messages_are_delayed_by(kind):
    """Quantiles of the table against draws of netem's own sampler; the far tail is in the table's last entry."""
    spec = parse_spec(f"{kind}:200,20")
    table = kernel_network(spec, "uplink").table
    assert table is not None
    sampler = spec.words[0].sampler(ImpairmentContext(1, "uplink", "", 0))
    messages = np.array([sampler.draw(0) for _ in range(40_000)])
    fractions = [0.01, 0.1, 0.5, 0.9, 0.99]
    np.testing.assert_allclose(
        np.quantile(drawn(table), fractions), np.quantile(messages, fractions), atol=0.002
    )
    assert drawn(table).mean() == pytest.approx(0.200, abs=0.0003)


def test_a_profile_keeps_the_published_moments():
    found = drawn(model_table(PROFILES["lund-stockholm"].model))
    assert 2 * found.mean() == pytest.approx(11.61e-3, rel=0.005)
    assert np.sqrt(2) * found.std() == pytest.approx(3.29e-3, rel=0.01)


def test_losses_of_a_profile_come_in_bursts():
    found = words("bursty-loss-5")
    assert "distribution farhand" in found
    arguments = found.split()
    enter, leave = (float(arguments[arguments.index("gemodel") + i].rstrip("%")) / 100 for i in (1, 2))
    assert enter / (enter + leave) == pytest.approx(0.05)
    assert 1 / leave == pytest.approx(5.0)


def test_empirical_delays_come_from_the_recording(tmp_path):
    path = tmp_path / "delays.csv"
    path.write_text("delay_ms\n" + "".join(f"{10 + i % 5}\n" for i in range(100)))
    network = kernel_network(parse_spec(f"empirical:{path},unit=ms,kind=one-way"), "uplink")
    assert network.table is not None
    delays = drawn(network.table)
    assert (delays.min(), delays.max()) == pytest.approx((0.010, 0.014), rel=1e-4)
    lognormal = kernel_network(parse_spec("lognormal:50,20"), "uplink").table
    assert lognormal is not None
    assert drawn(lognormal).mean() == pytest.approx(0.050, rel=0.01)
    assert drawn(lognormal).std() == pytest.approx(0.020, rel=0.03)


@pytest.mark.parametrize(
    ("stderr", "expected"),
    [
        (KIND_UNKNOWN, "no sch_netem"),
        ("Error: Specified qdisc not found.", "no sch_netem"),
        (NOT_PERMITTED, "NET_ADMIN"),
        ('Cannot find device "eth9"', "no network device 'eth9'"),
        ("tc: not found", "install iproute2"),
        ("Illegal\n  thing", "tc qdisc add dev eth9: Illegal thing"),
    ],
)
def test_a_refusal_is_one_line_that_says_what_to_do(stderr, expected):
    found = str(refusal(["tc", "qdisc", "add", "dev", "eth9"], stderr))
    assert expected in found
    assert "\n" not in found


class FakeShell:
    """Answers commands like a kernel that refuses what `refused` says."""

    def __init__(self, refused: str = "", stderr: str = KIND_UNKNOWN, handle: str = "0:") -> None:
        self.refused, self.stderr, self.handle = refused, stderr, handle
        self.commands: list[str] = []
        self.tables: list[str] = []

    def __call__(self, command, environment):
        line = " ".join(command)
        self.commands.append(line)
        if "TC_LIB_DIR" in environment:
            with open(f"{environment['TC_LIB_DIR']}/farhand.dist") as file:
                self.tables.append(file.read())
        if self.refused and self.refused in line:
            return 2, "", self.stderr
        if "show" in command:
            root = {"kind": "htb", "handle": self.handle, "packets": 7, "drops": 2}
            return 0, json.dumps([root]), ""
        return 0, "", ""


SETTINGS = NetemSettings(
    listen_operator="tcp/172.20.0.2:7447",
    listen_robot="tcp/172.21.0.2:7448",
    uplink="constant:10",
    downlink="loss:1%",
)


def test_uplink_goes_out_to_the_robot_and_everything_is_taken_back(capsys):
    shell = FakeShell()
    with kernel_emulation(SETTINGS, run=shell) as forwarding:
        assert (forwarding.uplink, forwarding.downlink) == ("none", "none")
    changed = [line for line in shell.commands if "show" not in line and line.startswith("tc")]
    assert changed == [
        "tc qdisc add dev eth1 root handle fa4d: netem limit 10000 delay 10ms",
        "tc qdisc add dev eth0 root handle fa4d: netem limit 10000 loss random 1%",
        "tc qdisc del dev eth0 root",
        "tc qdisc del dev eth1 root",
    ]
    assert "tc on eth1: 7 packets, 2 dropped" in capsys.readouterr().err


def test_one_direction_refused_takes_back_the_other():
    shell = FakeShell(refused="add dev eth0")
    with pytest.raises(InputError, match="no sch_netem"), kernel_emulation(SETTINGS, run=shell):
        pass
    assert shell.commands[-1] == "tc qdisc del dev eth1 root"


def test_a_failing_run_leaves_no_emulation_behind():
    shell = FakeShell()
    with pytest.raises(RuntimeError), kernel_emulation(SETTINGS, run=shell):
        raise RuntimeError
    assert shell.commands[-2:] == ["tc qdisc del dev eth0 root", "tc qdisc del dev eth1 root"]


def test_the_counts_go_into_the_statistics_too(tmp_path):
    stats = tmp_path / "stats.json"
    settings = msgspec.structs.replace(SETTINGS, stats=str(stats))
    with kernel_emulation(settings, run=FakeShell()):
        write_result(NetemResult(seed=0), stats)  # the proxy's
    found = json.loads(stats.read_text())
    assert found["seed"] == 0
    assert found["tc"][0] == {"device": "eth1", "direction": "uplink", "packets": 7, "dropped": 2}
    assert [each["direction"] for each in found["tc"]] == ["uplink", "downlink"]


def test_what_a_killed_emulation_left_is_taken_away_even_where_nothing_is_emulated(capsys):
    shell = FakeShell(handle=HANDLE)
    settings = msgspec.structs.replace(SETTINGS, uplink="none")
    with kernel_emulation(settings, run=shell):
        changed = [line for line in shell.commands if "show" not in line and line.startswith("tc")]
    assert changed[:3] == [
        "tc qdisc del dev eth1 root",
        "tc qdisc del dev eth0 root",
        "tc qdisc add dev eth0 root handle fa4d: netem limit 10000 loss random 1%",
    ]
    assert "tc on eth1: took away" in capsys.readouterr().err


def test_a_device_that_is_not_there_is_named():
    shell = FakeShell(refused="show dev eth1", stderr='Cannot find device "eth1"')
    with (
        pytest.raises(InputError, match="there is no network device 'eth1'"),
        kernel_emulation(SETTINGS, run=shell),
    ):
        pass


def test_a_queue_that_somebody_set_is_not_touched():
    shell = FakeShell(handle="1:")
    with pytest.raises(InputError, match=r"eth1 has a queueing discipline already \(htb 1:\)"):
        KernelEmulation([Device("eth1", kernel_network(parse_spec("constant:1"), "uplink"))], shell).start()
    assert not [line for line in shell.commands if "show" not in line]


def test_a_device_is_claimed_once_and_free_again():
    with claim("eth77"), pytest.raises(InputError, match="another emulation that runs has the device eth77"):
        claim("eth77")
    claim("eth77").close()


def test_the_table_reaches_tc_as_a_file():
    shell = FakeShell()
    emulation = KernelEmulation(
        [Device("eth1", kernel_network(parse_spec("lund-stockholm"), "uplink"))], shell
    )
    emulation.start()
    emulation.stop()
    assert len(shell.tables[0].split()) == SIZE


def test_devices_are_found_by_address_or_must_be_named():
    assert find_device("tcp/172.21.0.2:7448", "--tc-robot", addresses) == "eth1"
    with pytest.raises(InputError, match="name the device with --tc-robot"):
        find_device("tcp/10.1.2.3:7448", "--tc-robot", addresses)
    with (
        pytest.raises(InputError, match="both sides are on the device eth0"),
        kernel_emulation(SETTINGS, "eth0", "eth0", run=FakeShell()),
    ):
        pass


@pytest.mark.parametrize("change", [{"timeline": "x.toml"}, {"control": "7450"}])
def test_what_changes_a_running_network_is_refused(change):
    settings = NetemSettings(**change)
    with (
        pytest.raises(InputError, match="cannot be changed while it runs"),
        kernel_emulation(settings, "a", "b", run=FakeShell()),
    ):
        pass


def test_a_robot_s_own_network_is_refused():
    settings = msgspec.structs.replace(SETTINGS, robot_networks=(("arm2", "constant:100"),))
    with (
        pytest.raises(InputError, match="tells no robots apart"),
        kernel_emulation(settings, run=FakeShell()),
    ):
        pass


@pytest.mark.skipif(os.geteuid() != 0 or not shutil.which("unshare"), reason="needs root and unshare")
@pytest.mark.skipif(not shutil.which("tc"), reason="needs tc, of iproute2")
def test_this_kernel_emulates_or_refuses_in_one_line():
    """In a network namespace of its own: a kernel without sch_netem is told apart from one with it."""
    script = (
        "from farhand.netem.tc.backend import *\n"
        "from farhand.netem.tc.words import kernel_network\n"
        "from farhand.netem.spec import parse_spec\n"
        "emulation = KernelEmulation([Device('lo', kernel_network(parse_spec('constant:1'), 'uplink'))])\n"
        "try:\n    emulation.start()\n    print('started')\n    emulation.stop()\n"
        "except InputError as error:\n    print(error)\n"
    )
    done = subprocess.run(
        ["unshare", "--net", sys.executable, "-c", script],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if done.returncode and "unshare" in done.stderr:
        pytest.skip("may not make a network namespace")
    assert done.stdout.strip() in (
        "started",
        "--backend tc: this kernel has no sch_netem (modprobe sch_netem); use --backend message",
    ), done.stderr
