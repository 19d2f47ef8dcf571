"""The three programs on three hosts that have nothing but link-local addresses of IPv6."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from farhand.programs.command_line import NetemWords, OperatorWords, RobotWords
from farhand.site.certificates import issue, make_authority
from farhand.testing import short_task
from farhand.trials.hosts import Hosts, why_not

pytestmark = [
    pytest.mark.hosts,
    pytest.mark.slow,
    pytest.mark.skipif(bool(why_not()), reason=why_not() or "-"),
]

NETEM, OTHER = "fe80::7", "fe80::8"
"""netem has one and the same address on both cables: only the device tells them apart."""


NAME = "netem.lab"
NAMES = Path("/etc/netns")
"""Where `ip netns exec` takes a namespace's /etc/hosts from."""


@pytest.fixture
def hosts():
    hosts = Hosts()
    for host in ("operator", "robot"):
        folder = NAMES / hosts.namespace(host)
        folder.mkdir(parents=True)
        (folder / "hosts").write_text(f"127.0.0.1 localhost\n{NETEM} {NAME}\n")
    for host, device, address in [
        ("netem", "to-operator", NETEM),
        ("netem", "to-robot", NETEM),
        ("operator", "cable", OTHER),
        ("robot", "cable", OTHER),
    ]:
        where = ["ip", "-n", hosts.namespace(host), "addr"]
        subprocess.run([*where, "flush", "dev", device], check=True, timeout=20)
        subprocess.run([*where, "add", f"{address}/64", "dev", device, "nodad"], check=True, timeout=20)
    yield hosts
    hosts.close()
    for host in ("operator", "robot"):
        shutil.rmtree(NAMES / hosts.namespace(host))


@pytest.mark.long
@pytest.mark.parametrize("protocol", ["tcp", "tls"])
def test_a_task_and_the_doctor_over_link_local_addresses(hosts, tmp_path, protocol):
    members = {"netem": ("netem", "lab"), "robot": ("robot", "point"), "operator": ("operator", "alice")}
    secured = {key: {"insecure": True} for key in members}
    if protocol == "tls":
        make_authority(tmp_path / "certs")
        issue(tmp_path / "certs", *members["netem"], hosts=[NAME])
        issue(tmp_path / "certs", *members["robot"])
        issue(tmp_path / "certs", *members["operator"], ["point"])
        secured = {part: {"tls": str(tmp_path / "certs" / ".".join(who))} for part, who in members.items()}
    task = str(short_task(tmp_path))
    netem = NetemWords(
        network="constant:20",
        listen_operator=f"{protocol}/[{NETEM}%to-operator]:7447",
        listen_robot=f"{protocol}/[{NETEM}]:7448#iface=to-robot",
        **secured["netem"],
    )
    hosts.start("netem", "farhand", *netem.words(), log=tmp_path / "netem.log")
    tcp = protocol == "tcp"
    there = f"tcp/[{NETEM}%cable]:7448" if tcp else f"tls/{NAME}:7448#iface=cable"
    robot = RobotWords(robot="point", scenario=task, connect=(there,), **secured["robot"])
    hosts.start("robot", "farhand", *robot.words(), log=tmp_path / "robot.log")
    near = f"tcp/[{NETEM}]:7447#iface=cable" if tcp else f"tls/{NAME}:7447#iface=cable"
    operator = OperatorWords(
        robot="point", scenario=task, connect=(near,), time_limit=60, **secured["operator"]
    )
    driving = hosts.start("operator", "farhand", *operator.words(), log=tmp_path / "operator.log")
    assert driving.wait(100) == 0, (tmp_path / "operator.log").read_text()
    words = ["doctor", "--json", "--scenario", task, "--robot", "point", "--connect", near]
    if not tcp:
        words += ["--tls", secured["operator"]["tls"]]
    looking = hosts.start("operator", "farhand", *words)
    out, _ = looking.communicate(timeout=60)
    found = json.loads(out.splitlines()[-1])
    assert [each for each in found if each["level"] == "bad"] == []
    assert "reachability" in [each["what"] for each in found if each["level"] == "good"]
