"""Two robots of one name are told by everybody; with TLS an emergency stop needs a certificate that may command."""

import json

import pytest

from farhand.common.errors import InputError
from farhand.common.link.ports import free_ports
from farhand.runs.scenario import load_scenario
from farhand.site.certificates import issue, make_authority
from farhand.site.doctor.doctor import examine
from farhand.site.estop import emergency_stop
from farhand.site.robots import list_robots
from farhand.testing import Programs, Witness, short_task

pytestmark = pytest.mark.realtime
FAR = [(50.0, 0.0, 0.5)]


@pytest.mark.long
def test_two_robots_of_one_name_are_told_and_held(tmp_path, capsys):
    up, down, reports = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))
    task = ("--scenario", short_task(tmp_path, FAR), "--robot", "r")
    with Programs() as programs:
        programs.start("netem", "--listen-operator", up, "--listen-robot", down)
        programs.start("robot", *task, "--connect", down)
        operator = programs.start("operator", *task, "--connect", up, "--report", reports)
        witness = Witness(up, reports=reports)
        try:
            witness.wait_until(lambda s: s.mode == "run" and s.velocity[0] > 0.1)
            assert list_robots([up], "", as_json=True) == 0
            (row,) = json.loads(capsys.readouterr().out)["robots"]
            assert (row["there"], row["mode"]) == ("yes", "run: commanded")
            assert row["state_age"] < 1.0
            programs.start("robot", *task, "--connect", down)
            operator.wait_for("two robots call themselves 'r'")
            assert list_robots([up], "", as_json=True) == 1
            (row,) = json.loads(capsys.readouterr().out)["robots"]
            assert row["there"] == "several"
            findings = examine(up, "r", "", load_scenario("point-obstacle"), 40)
            assert [f.level for f in findings if f.what == "one robot"] == ["bad"]
            assert [f.level for f in findings if f.what == "scenario"] == ["note", "note"]
            assert witness.reports[-1].mode == "hold"
        finally:
            witness.close()


def test_with_tls_an_operator_stops_it_and_an_observer_is_refused_at_once(tmp_path, capsys):
    certs = tmp_path / "certs"
    make_authority(certs)
    for role, name, robots in (
        ("robot", "r", []),
        ("operator", "alice", ["r"]),
        ("observer", "eve", ["r"]),
        ("operator", "bob", ["box"]),
    ):
        issue(certs, role, name, robots)
    endpoint = f"tls/127.0.0.1:{free_ports(1)[0]}"
    task = ("--scenario", short_task(tmp_path, FAR), "--robot", "r")
    with Programs() as programs:
        robot = programs.start("robot", *task, "--listen", endpoint, "--tls", certs / "robot.r")
        programs.start("operator", *task, "--connect", endpoint, "--tls", certs / "operator.alice")
        robot.wait_for("has control")
        for name, said in (("observer.eve", "must not command"), ("operator.bob", "is for box")):
            with pytest.raises(InputError, match=said):
                emergency_stop("r", [endpoint], str(certs / name))
        assert emergency_stop("r", [endpoint], str(certs / "operator.alice")) == 0
        robot.wait_for("stop: emergency stop by operator.alice")
