"""The authority, its members' folders, and what access follows from a certificate."""

import json
import os
import stat
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from farhand.common.errors import CertificateError, EndpointError, InputError
from farhand.common.link.presence import answerer
from farhand.common.process.security import Access, secure
from farhand.common.timing.clock import utc_seconds
from farhand.common.trust.access import access_control
from farhand.common.trust.certificate import read_certificate
from farhand.common.trust.expiry import ExpiryWatch
from farhand.common.trust.tls import load_folder, nested
from farhand.site.certificates import exclusive, issue, make_authority, members, renew


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
        ("operator", "al ice", ["ur5"]),
        ("operator", "../alice", ["ur5"]),
        ("operator", "alice", ["a/b"]),
        ("operator", "älice", ["ur5"]),
    ],
)
def test_impossible_members(authority, role, name, robots):
    with pytest.raises(InputError) as refused:
        issue(authority, role, name, robots)
    assert "\n" not in str(refused.value)


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


def test_an_operator_may_write_only_commands_and_changes_of_the_scene_of_its_robots(authority):
    netem, alice = (load_folder(authority / name).own for name in ("netem.lab", "operator.alice"))
    rules = access_control(netem, [alice])["rules"]
    writes = {
        key
        for rule in rules
        if "ingress" in rule["flows"] and {"put", "delete"} & set(rule["messages"])
        for key in rule["key_exprs"]
    }
    assert writes == {"farhand/ur5/command", "farhand/ur5/scene_request"}
    robot = load_folder(authority / "robot.ur5").own
    rules = access_control(netem, [robot])["rules"]
    writes = {k for r in rules if "ingress" in r["flows"] and "put" in r["messages"] for k in r["key_exprs"]}
    assert writes == {
        "farhand/ur5/state",
        "farhand/ur5/scene",
        "farhand/ur5/description",
        "farhand/ur5/camera/**",
    }


def test_a_camera_may_write_only_pictures_of_its_robots_and_hears_no_command(authority):
    camera = issue(authority, "camera", "front", ["ur5"])
    own = load_folder(camera, "camera", "ur5").own
    for name, place in (("netem.lab", "netem-robot"), ("robot.ur5", "robot"), ("operator.alice", "operator")):
        folder = load_folder(authority / name)
        assert own in folder.accepted(place)
        rules = access_control(folder.own, [own])["rules"]
        for flow, message, keys in (
            ("ingress", "put", {"farhand/ur5/camera/**"}),
            ("egress", "put", {"farhand/ur5/state", "farhand/ur5/scene", "farhand/ur5/description"}),
        ):
            found = {
                k for r in rules if flow in r["flows"] and message in r["messages"] for k in r["key_exprs"]
            }
            assert found == keys, (name, flow)
    assert own not in load_folder(authority / "netem.lab").accepted("netem-operator")


def test_settings_nest_into_a_router_configuration(authority):
    issue(authority, "router", "hub")
    made = nested(load_folder(authority / "router.hub", "router").settings("router"))
    assert made["transport"]["link"]["tls"]["enable_mtls"] is True
    assert made["access_control"]["default_permission"] == "deny"


def test_without_tls_only_this_host(authority):
    said = []
    assert (
        secure(
            Access(connect=("tcp/127.0.0.1:7447",), listen=("tcp/127.0.0.1:7448",)),
            said.append,
        )
        is None
    )
    assert said == []
    with pytest.raises(EndpointError, match="--insecure"):
        secure(Access(listen=("tcp/0.0.0.0:7447",)), said.append)
    secure(Access(insecure=True, listen=("tcp/0.0.0.0:7447",)), said.append)
    assert "INSECURE" in said[-1]
    with pytest.raises(EndpointError, match="needs --tls"):
        secure(Access(connect=("tls/127.0.0.1:7447",)), said.append)
    with pytest.raises(EndpointError, match="must be tls/"):
        secure(
            Access(tls=str(authority / "netem.lab"), connect=("tcp/127.0.0.1:7447",), listen=()),
            said.append,
        )
    with pytest.raises(InputError, match="exclude"):
        secure(Access(tls=str(authority / "netem.lab"), insecure=True), said.append)


def test_folders_are_their_owners_alone(tmp_path):
    make_authority(tmp_path / "certs")
    made = issue(tmp_path / "certs", "robot", "ur5")
    assert {stat.S_IMODE(path.stat().st_mode) for path in (tmp_path / "certs", made)} == {0o700}


@pytest.mark.parametrize("host", ["10.0.0.5:7447", "tls/lab", "bad host", "", "ä.example", "-x"])
def test_impossible_hosts(authority, host):
    with pytest.raises(CertificateError, match="--host"):
        issue(authority, "netem", "other", hosts=[host])


def test_a_certificate_ends_with_its_authority_at_the_latest(tmp_path):
    make_authority(tmp_path / "certs", days=10)
    made = issue(tmp_path / "certs", "robot", "ur5", days=365)
    own, ca = read_certificate(made / "cert.pem"), read_certificate(tmp_path / "certs" / "ca.pem")
    assert own.certificate.not_valid_after_utc <= ca.certificate.not_valid_after_utc
    assert own.days_left > 9.9
    for days in (float("nan"), float("inf"), 1e9):
        with pytest.raises(InputError, match="--days"):
            issue(tmp_path / "certs", "robot", "box", days=days)


def test_two_issues_at_the_same_time_make_both_and_tell_each_of_the_other(authority):
    def make(number):
        with exclusive(authority):
            return issue(authority, "robot", f"arm{number}")

    with ThreadPoolExecutor(8) as pool:
        made = list(pool.map(make, range(16)))
    names = {path.name for path in made}
    for path in made:
        assert names <= {file.stem for file in (path / "members").glob("*.pem")}
        load_folder(path, "robot")


def test_a_folder_that_cannot_be_used_is_one_line():
    for call in (lambda f: make_authority(f), lambda f: issue(f, "robot", "ur5")):
        for folder in (Path("/proc/nothing"), Path("/dev/null")):
            with pytest.raises(CertificateError) as refused, exclusive(folder, create=True):
                call(folder)
            assert "\n" not in str(refused.value)
            assert str(folder) in str(refused.value)


def test_a_wrong_clock_is_thought_of(authority, monkeypatch):
    """A clock ten years behind: not valid yet; ten years ahead: ended. Both lines name this host's clock."""
    now = utc_seconds()
    for years, text in ((-10, "not valid before"), (10, "ended on")):
        monkeypatch.setattr(
            "farhand.common.trust.certificate.utc_seconds", lambda years=years: now + years * 365.25 * 86_400
        )
        with pytest.raises(CertificateError, match=f"{text}.*this host's clock says"):
            load_folder(authority / "operator.alice")


def test_a_running_program_warns_once_a_day_and_at_the_end(authority):
    """In virtual time: 40 days of looking every hour at a certificate that has 35, and one that is near its end."""
    own = read_certificate(issue(authority, "operator", "alice", ["ur5"], days=35, force=True) / "cert.pem")
    near = read_certificate(issue(authority, "robot", "box", days=20) / "cert.pem")
    far = read_certificate(authority / "netem.lab" / "cert.pem")
    start = utc_seconds()
    watch = ExpiryWatch([own, near, far], start)
    said = [(hour / 24.0, line) for hour in range(40 * 24) for line in watch.step(start + hour * 3600.0)]
    mine = [(day, line) for day, line in said if "operator.alice" in line]
    assert [round(day) for day, _ in mine[:3]] == [5, 6, 7]
    assert len(mine) == 31
    assert "ends in 30 days" in mine[0][1]
    assert "ends in 24 hours" in mine[-2][1]
    assert "has ended" in mine[-1][1]
    assert mine[-1][0] == pytest.approx(35, abs=0.1)
    others = [day for day, line in said if "robot.box" in line]
    assert others[0] == pytest.approx(1.0)  # the start itself has said it
    assert others[-1] == pytest.approx(20, abs=0.1)
    assert len(said) == len(mine) + len(others)
    assert len(watch.step(start)) == 1  # the clock was put back, to where one is near its end


def test_a_program_answers_with_the_days_left_now_not_those_of_its_start(authority, monkeypatch):
    answer = answerer("robot", read_certificate(authority / "robot.ur5" / "cert.pem"))
    first = json.loads(answer())
    now = utc_seconds()
    monkeypatch.setattr("farhand.common.trust.certificate.utc_seconds", lambda: now + 100 * 86_400.0)
    assert json.loads(answer())["days_left"] == pytest.approx(first["days_left"] - 100, abs=0.1)


def test_a_clock_that_is_put_back_does_not_silence_the_watch(authority):
    own = read_certificate(issue(authority, "operator", "alice", ["ur5"], days=20, force=True) / "cert.pem")
    start = utc_seconds()
    watch = ExpiryWatch([own], start)
    assert watch.step(start + 3600) == []
    assert len(watch.step(start - 5 * 86_400.0)) == 1
    assert watch.step(start - 5 * 86_400.0 + 60) == []


@pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to become somebody else")
def test_an_unreadable_folder_is_one_line(authority):
    os.seteuid(65_534)
    try:
        for call in (lambda: load_folder(authority / "robot.ur5"), lambda: members(authority)):
            with (
                pytest.raises(CertificateError, match=r"(cannot be read|cannot be used).*ermission denied"),
                exclusive(authority),
            ):
                call()
        with pytest.raises(CertificateError, match="cannot be read: Permission denied"):
            load_folder(authority / "robot.ur5")
    finally:
        os.seteuid(0)
