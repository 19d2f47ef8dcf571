"""Three hosts in network namespaces: real programs, real attacks, and the doctor between two of them."""

import json

import pytest

from farhand.programs.command_line import NetemWords, RobotWords
from farhand.site.certificates import issue, make_authority
from farhand.trials.faults.attacks import attacks, perform
from farhand.trials.faults.rig import Rig
from farhand.trials.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT, Hosts, why_not

pytestmark = [
    pytest.mark.hosts,
    pytest.mark.slow,
    pytest.mark.skipif(bool(why_not()), reason=why_not() or "-"),
]


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    rig = Rig(tmp_path_factory.mktemp("faults"), attack_time=1.5)
    yield rig
    rig.hosts.close()


def test_recorded_commands_move_nothing(rig):
    done = perform(rig, "recorded", attacks()["recorded commands replayed"])
    assert done.unsafe == ()
    assert done.outcome.refused.get("old-seq", 0) > 50
    assert done.outcome.standing is None  # the lawful operator kept control


def test_an_operator_of_another_robot_is_refused_by_name(rig):
    done = perform(rig, "another", attacks()["operator of another robot"])
    assert done.unsafe == ()
    assert "operator.bob may not" in done.line
    assert (done.found["connected"], done.found["read"]) == (True, 0)
    assert done.outcome.refused == {}


def test_a_link_that_breaks_stops_the_robot_and_is_made_good(rig):
    outcome, _ = rig.measure(lambda: rig.unplugged("robot", 2.0))
    assert outcome.unsafe == ()
    assert outcome.standing is not None
    assert outcome.acknowledged is not None
    assert outcome.lost > 5


@pytest.fixture(scope="module")
def hosts(tmp_path_factory):
    folder = tmp_path_factory.mktemp("doctor")
    certs = folder / "certs"
    make_authority(certs)
    issue(certs, "netem", "lab", hosts=[NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT])
    issue(certs, "robot", "point")
    issue(certs, "operator", "alice", ["point", "box"])
    make_authority(folder / "other")
    issue(folder / "other", "operator", "alice", ["point"])
    hosts = Hosts()
    netem = NetemWords(
        tls=str(certs / "netem.lab"),
        uplink="loss:70%",
        listen_operator="tls/0.0.0.0:7447",
        listen_robot="tls/0.0.0.0:7448",
    )
    hosts.start("netem", "farhand", *netem.words(), log=folder / "netem.log")
    robot = RobotWords(
        tls=str(certs / "robot.point"),
        robot="point",
        scenario="point-obstacle",
        connect=(f"tls/{NETEM_FOR_ROBOT}:7448",),
    )
    hosts.start("robot", "farhand", *robot.words(), log=folder / "robot.log")
    yield hosts, folder
    hosts.close()


def findings(hosts, *words):
    process = hosts.start("operator", "farhand", "doctor", "--json", "--scenario", "point-obstacle", *words)
    out, _ = process.communicate(timeout=60)
    return process.returncode, [f for f in json.loads(out.splitlines()[-1]) if f["level"] == "bad"]


@pytest.mark.long
def test_the_doctor_finds_each_planted_fault(hosts):
    hosts, folder = hosts
    good = ["--tls", str(folder / "certs" / "operator.alice")]
    there = ["--connect", f"tls/{NETEM_FOR_OPERATOR}:7447", "--robot", "point"]
    for _ in range(10):  # until the robot is up
        code, bad = findings(hosts, *good, *there)
        if [f["what"] for f in bad] == ["loss"]:
            break
    assert (code, [f["what"] for f in bad]) == (1, ["loss"])
    planted = {
        "reachability": [*good, "--connect", f"tls/{NETEM_FOR_OPERATOR}:7449", "--robot", "point"],
        "TLS": ["--tls", str(folder / "other" / "operator.alice"), *there],
        "robot": [*good, "--connect", f"tls/{NETEM_FOR_OPERATOR}:7447", "--robot", "box"],
        "certificate": there,
    }
    for what, words in planted.items():
        code, bad = findings(hosts, *words)
        assert (code, [f["what"] for f in bad]) == (1, [what])
        assert bad[0]["remedy"]
    hosts.plug("operator", False)
    try:
        code, bad = findings(hosts, *good, *there)
    finally:
        hosts.plug("operator", True)
    assert (code, [f["what"] for f in bad]) == (1, ["reachability"])
