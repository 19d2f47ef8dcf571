"""The real programs through Zenoh routers with the configuration that `farhand certs zenohd` prints.

`zenohd` itself is this very library in router mode with this very file; it is not in the Python package.
"""

import json
import signal

import pytest
import zenoh

from farhand.commands.certs import zenohd
from farhand.common.link.ports import free_ports
from farhand.programs.command_line import NetemWords, OperatorWords, RobotWords
from farhand.runs.scenario import load_scenario
from farhand.site.certificates import issue, make_authority
from farhand.site.doctor.doctor import examine
from farhand.site.robots import list_robots

pytestmark = pytest.mark.realtime


@pytest.fixture
def certificates(tmp_path):
    folder = tmp_path / "certs"
    make_authority(folder)
    for name in ("hub", "far"):
        issue(folder, "router", name)
    issue(folder, "netem", "lab", days=12)
    for operator, robot in (("alice", "ur5"), ("bob", "box")):
        issue(folder, "robot", robot)
        issue(folder, "operator", operator, [robot])
    return folder


@pytest.fixture
def routers(certificates, tmp_path, capsys):
    """Endpoints of two routers, which know nothing of each other."""
    sessions, endpoints = [], []
    for name, port in zip(("hub", "far"), free_ports(2), strict=True):
        endpoints.append(f"tls/127.0.0.1:{port}")
        zenohd(certificates / f"router.{name}", [endpoints[-1]])
        file = tmp_path / f"{name}.json5"
        file.write_text(capsys.readouterr().out)
        sessions.append(zenoh.open(zenoh.Config.from_file(str(file))))
    yield endpoints
    for session in sessions:
        session.close()


def test_the_printed_configuration_is_one_of_zenoh(certificates, capsys):
    zenohd(certificates / "router.hub", None, ["tls/10.0.0.9:7447"])
    config = zenoh.Config.from_json5(capsys.readouterr().out)
    assert config.get_json("mode") == '"router"'
    assert json.loads(config.get_json("listen/endpoints")) == ["tls/0.0.0.0:7447"]
    assert json.loads(config.get_json("connect/endpoints")) == ["tls/10.0.0.9:7447"]
    assert json.loads(config.get_json("transport/link/tls/enable_mtls")) is True
    assert json.loads(config.get_json("transport/link/tx/lease")) == 1000
    access = json.loads(config.get_json("access_control"))
    assert (access["enabled"], access["default_permission"]) == (True, "deny")
    assert {s["id"] for s in access["subjects"]} >= {"operator.alice", "robot.ur5", "netem.lab", "router.far"}


@pytest.mark.long
def test_tasks_through_routers_and_an_emulator_between_two_of_them(
    started, scenario, certificates, routers, tmp_path, capsys
):
    """bob -> hub -> box, and alice -> hub -> emulator -> far -> ur5; both drive their task to its end."""
    hub, far = routers

    def program(words, name, robot, endpoint, **more):
        place = {"robot": robot, "router": True, "connect": (endpoint,), "tls": str(certificates / name)}
        return started(words(scenario=scenario, **place, **more))

    netem = started(
        NetemWords(
            network="constant:40",
            connect_operator=(hub,),
            connect_robot=(far,),
            tls=str(certificates / "netem.lab"),
        )
    )
    robots = [program(RobotWords, "robot.box", "box", hub), program(RobotWords, "robot.ur5", "ur5", far)]
    netem.wait_for("ends in 12 days")
    result = tmp_path / "alice.json"
    operators = [
        program(OperatorWords, "operator.bob", "box", hub),
        program(OperatorWords, "operator.alice", "ur5", hub, result=str(result)),
    ]
    assert [each.wait() for each in operators] == [0, 0]
    assert json.loads(result.read_text())["rtt_mean"] > 0.08

    tls = str(certificates / "operator.alice")
    capsys.readouterr()
    assert list_robots([hub], tls, as_json=True, router=True) == 0
    listed = json.loads(capsys.readouterr().out)
    assert listed["netem"]
    assert [(row["robot"], row["there"]) for row in listed["robots"]] == [
        ("ur5", "yes")
    ]  # box is not alice's
    findings = examine(hub, "ur5", tls, load_scenario(str(scenario)), 10, router=True)
    levels = {f.what: f.level for f in findings}
    assert "bad" not in levels.values(), findings
    assert (levels["router"], levels["emulator"], levels["certificate, emulator"]) == ("good", "good", "note")
    assert (levels["certificate, robot"], levels["versions, robot"], levels["states"]) == ("good",) * 3
    assert any(
        f.what == "router" and "--router" in f.remedy
        for f in examine(hub, "ur5", tls, load_scenario(str(scenario)), 1)
    )
    for each in (*robots, netem):
        each.signal(signal.SIGINT)
    assert [each.wait() for each in (*robots, netem)] == [0, 0, 0]
