"""The authority, its members' folders, and what access follows from a certificate."""

import stat

import pytest

from common.access import access_control
from common.certificate import read_certificate
from common.errors import CertificateError, EndpointError, InputError
from common.tls import load_folder, nested
from farhand.certificates import issue, make_authority, members, renew
from farhand.security import secure


@pytest.fixture
def authority(tmp_path):
    folder = tmp_path / "certs"
    make_authority(folder)
    issue(folder, "netem", "lab", hosts=["10.0.0.5"])
    issue(folder, "robot", "ur5")
    issue(folder, "operator", "alice", ["ur5"])
    return folder


def test_keys_are_secret_and_names_are_as_asked(authority):
    for key in (authority / "ca-key.pem", *authority.glob("*/key.pem")):
        assert stat.S_IMODE(key.stat().st_mode) == 0o600
    alice = read_certificate(authority / "operator.alice" / "cert.pem")
    assert (alice.name, alice.role, alice.robots) == ("operator.alice", "operator", ("ur5",))
    assert "10.0.0.5" in read_certificate(authority / "netem.lab" / "cert.pem").hosts
    assert 364 < alice.days_left <= 365
    assert {m.name for m in members(authority)} == {"netem.lab", "robot.ur5", "operator.alice"}


def test_nothing_is_overwritten_without_force(authority):
    before = (authority / "robot.ur5" / "key.pem").read_bytes()
    with pytest.raises(CertificateError, match="--force"):
        issue(authority, "robot", "ur5")
    with pytest.raises(CertificateError, match="--force"):
        make_authority(authority)
    assert (authority / "robot.ur5" / "key.pem").read_bytes() == before
    issue(authority, "robot", "ur5", force=True)
    assert (authority / "robot.ur5" / "key.pem").read_bytes() != before


def test_renewal_keeps_the_rights_and_changes_the_key(authority):
    old = (authority / "operator.alice" / "key.pem").read_bytes()
    renew(authority, "operator.alice", days=500)
    own = load_folder(authority / "operator.alice", "operator", "ur5").own
    assert own.robots == ("ur5",)
    assert own.days_left > 499
    assert (authority / "operator.alice" / "key.pem").read_bytes() != old
    with pytest.raises(CertificateError, match=r"alice, robot\.ur5"):
        renew(authority, "operator.bob")


@pytest.mark.parametrize(
    ("role", "name", "robots"),
    [
        ("chief", "a", []),
        ("operator", "a", []),
        ("netem", "a", ["ur5"]),
        ("robot", "a/b", []),
        ("robot", "netem", []),
    ],
)
def test_impossible_members(authority, role, name, robots):
    with pytest.raises(InputError):
        issue(authority, role, name, robots)


def test_a_folder_must_fit_its_program(authority):
    with pytest.raises(CertificateError, match="not one of the role operator"):
        load_folder(authority / "robot.ur5", "operator")
    with pytest.raises(CertificateError, match="named for ur5, not for 'box'"):
        load_folder(authority / "operator.alice", "operator", "box")
    with pytest.raises(CertificateError, match=r"there is no cert\.pem"):
        load_folder(authority)
    key = authority / "robot.ur5" / "key.pem"
    key.write_bytes((authority / "netem.lab" / "key.pem").read_bytes())
    with pytest.raises(CertificateError, match="does not belong"):
        load_folder(authority / "robot.ur5")


def test_an_ended_certificate_is_refused_and_one_near_its_end_warns(authority):
    issue(authority, "operator", "alice", ["ur5"], days=5, force=True)
    assert any("ends in 5 days" in line for line in load_folder(authority / "operator.alice").warnings)
    issue(authority, "operator", "alice", ["ur5"], days=-1, force=True)
    with pytest.raises(CertificateError, match=r"ended on .*renew operator\.alice"):
        load_folder(authority / "operator.alice")
    netem = load_folder(authority / "netem.lab")
    assert "operator.alice" not in {m.name for m in netem.members}
    assert any("left out: operator.alice.pem" in line for line in netem.warnings)


def test_a_member_of_another_authority_gives_no_right(authority, tmp_path):
    make_authority(tmp_path / "other")
    foreign = issue(tmp_path / "other", "operator", "mallory", ["ur5"])
    (authority / "netem.lab" / "members" / "operator.mallory.pem").write_bytes(
        (foreign / "cert.pem").read_bytes()
    )
    netem = load_folder(authority / "netem.lab")
    assert "operator.mallory" not in {m.name for m in netem.members}
    assert any("not signed by this authority" in line for line in netem.warnings)
    (authority / "robot.ur5" / "ca.pem").write_bytes((tmp_path / "other" / "ca.pem").read_bytes())
    with pytest.raises(CertificateError, match="not signed"):
        load_folder(authority / "robot.ur5")


def test_an_operator_may_write_only_the_command_of_its_robots(authority):
    netem, alice = (load_folder(authority / name).own for name in ("netem.lab", "operator.alice"))
    rules = access_control(netem, [alice])["rules"]
    writes = {
        key
        for rule in rules
        if "ingress" in rule["flows"] and {"put", "delete"} & set(rule["messages"])
        for key in rule["key_exprs"]
    }
    assert writes == {"farhand/ur5/command"}
    robot = load_folder(authority / "robot.ur5").own
    rules = access_control(netem, [robot])["rules"]
    writes = {k for r in rules if "ingress" in r["flows"] and "put" in r["messages"] for k in r["key_exprs"]}
    assert writes == {"farhand/ur5/state", "farhand/ur5/scene", "farhand/ur5/camera/**"}


def test_settings_nest_into_a_router_configuration(authority):
    issue(authority, "router", "hub")
    made = nested(load_folder(authority / "router.hub", "router").settings("router"))
    assert made["transport"]["link"]["tls"]["enable_mtls"] is True
    assert made["access_control"]["default_permission"] == "deny"


def test_without_tls_only_this_host(authority):
    said = []
    assert secure("", False, ["tcp/127.0.0.1:7447"], ["tcp/127.0.0.1:7448"], said.append) is None
    assert said == []
    with pytest.raises(EndpointError, match="--insecure"):
        secure("", False, [], ["tcp/0.0.0.0:7447"], said.append)
    secure("", True, [], ["tcp/0.0.0.0:7447"], said.append)
    assert "INSECURE" in said[-1]
    with pytest.raises(EndpointError, match="needs --tls"):
        secure("", False, ["tls/127.0.0.1:7447"], [], said.append)
    with pytest.raises(EndpointError, match="must be tls/"):
        secure(str(authority / "netem.lab"), False, ["tcp/127.0.0.1:7447"], [], said.append)
    with pytest.raises(InputError, match="exclude"):
        secure(str(authority / "netem.lab"), True, [], [], said.append)
