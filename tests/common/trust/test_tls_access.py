"""Attackers against the emulator's TLS side over real Zenoh: none moves a robot, none sees one."""

import socket
import ssl
import threading
from contextlib import contextmanager, suppress

import pytest
import zenoh

from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock
from farhand.common.trust.tls import TlsFolder, load_folder, read_certificate, watch_names
from farhand.netem.check.check import free_ports
from farhand.netem.proxy import Meeting, Proxy
from farhand.runs.scenario import load_scenario
from farhand.site.certificates import issue, make_authority
from farhand.site.doctor.doctor import examine
from farhand.site.doctor.network import probe_tls
from farhand.site.robots import alive, meet

pytestmark = pytest.mark.realtime
PATIENCE = 20.0
COMMAND, STATE = "farhand/ur5/command", "farhand/ur5/state"


class Rig:
    """The emulator's two TLS sessions in this process, and a robot that counts what reaches it."""

    def __init__(self, folder):
        make_authority(folder)
        issue(folder, "netem", "lab")
        for robot in ("ur5", "box"):
            issue(folder, "robot", robot)
        issue(folder, "operator", "alice", ["ur5"])
        issue(folder, "operator", "bob", ["box"])
        self.folder = folder
        own = load_folder(folder / "netem.lab")
        self.said, self.heard = [], threading.Event()
        ports = free_ports(2)
        self.operator_side, self.robot_side = (f"tls/127.0.0.1:{port}" for port in ports)
        self.arrived = []
        self.wakened = threading.Event()
        self.proxy = Proxy(
            Meeting(self.operator_side, extra=tuple(own.settings("netem-operator"))),
            Meeting(self.robot_side, extra=tuple(own.settings("netem-robot"))),
            SystemClock(),
            self.wakened.set,
        )
        self.watch = watch_names(self.proxy.operator_link.session, own, "netem-operator", self.say)
        self.sessions = []

    def say(self, line):
        self.said.append(line)
        self.heard.set()

    def connect(self, folder, checked=True, endpoint=None, mode="peer"):
        """A session with the certificate in a folder; unchecked: an attacker's, who asks no rule of ours."""
        if checked:
            extra = load_folder(folder).settings("operator")
        else:
            own = read_certificate(folder / "cert.pem")
            extra = [
                s
                for s in TlsFolder(folder, own, own, (), ()).settings("operator")
                if s[0] != "access_control"
            ]
        session = open_session([endpoint or self.operator_side], mode=mode, extra=extra)
        self.sessions.append(session)
        return session

    def took(self):
        """Keys that the emulator took in from the operator's side, after a lawful marker."""
        return {p.key for p in self.proxy.operator_link.receive() if p.payload}

    def close(self):
        for session in self.sessions:
            session.close()
        self.proxy.close()


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    rig = Rig(tmp_path_factory.mktemp("tls") / "certs")
    yield rig
    rig.close()


def received(session, key):
    """An event that a message under the key sets."""
    event = threading.Event()
    session.declare_subscriber(key, lambda _: event.set())
    return event


def put_until(send, event, limit=PATIENCE):
    """Send again and again until the event is set."""
    for _ in range(int(limit * 10)):
        send()
        if event.wait(0.1):
            return True
    return False


def lawful_marker(rig):
    """A command of the lawful operator that the emulator took in: what was sent before it has been judged."""
    alice = rig.connect(rig.folder / "operator.alice")
    rig.wakened.clear()
    assert put_until(lambda: alice.put(COMMAND, b"lawful"), rig.wakened)
    return alice


@contextmanager
def tls_server(folder):
    """Something with TLS that takes one connection; its endpoint."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(folder / "cert.pem", folder / "key.pem")
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def serve():
            connection, _ = listening.accept()
            with connection, suppress(OSError), context.wrap_socket(connection, server_side=True) as secured:
                secured.recv(1)  # until the other end closes it

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield f"tls/127.0.0.1:{listening.getsockname()[1]}"
        thread.join(PATIENCE)


def test_the_lawful_operator_reaches_its_robot_only(rig):
    alice = lawful_marker(rig)
    state, other = received(alice, STATE), received(alice, "farhand/box/state")
    netem = rig.proxy.operator_link.session
    for key in ("farhand/box/command", STATE, "farhand/*/command", "hello"):
        alice.put(key, b"x")
    assert put_until(lambda: [netem.put(k, b"s") for k in ("farhand/box/state", STATE)], state)
    taken = rig.took()
    assert COMMAND in taken
    # What alice said to her own subscribers stays with her; the emulator took in nothing but her command.
    assert taken == {COMMAND}
    assert not other.is_set()


def test_an_operator_of_another_robot(rig):
    bob = rig.connect(rig.folder / "operator.bob", checked=False)
    assert meet(bob, PATIENCE)
    seen, own = received(bob, STATE), received(bob, "farhand/box/state")
    netem = rig.proxy.operator_link.session
    for _ in range(20):
        bob.put(COMMAND, b"x")
    assert put_until(lambda: [netem.put(k, b"s") for k in (STATE, "farhand/box/state")], own)
    bob.put("farhand/box/command", b"own")
    assert not seen.is_set()
    assert {p.payload for p in rig.proxy.operator_link.receive() if p.key == COMMAND} <= {b"lawful"}


def test_a_name_that_no_rule_has_is_told_of(rig):
    gone = issue(rig.folder, "operator", "gone", ["ur5"])  # after the emulator's start
    rig.heard.clear()
    session = rig.connect(gone, checked=False)
    assert meet(session, PATIENCE)
    assert rig.heard.wait(PATIENCE)
    assert any("operator.gone" in line and "given nothing" in line for line in rig.said)
    seen = received(session, STATE)
    for _ in range(20):
        session.put(COMMAND, b"gone")
    lawful_marker(rig)
    rig.proxy.operator_link.session.put(STATE, b"s")
    assert not seen.wait(0.5)
    assert b"gone" not in {p.payload for p in rig.proxy.operator_link.receive()}
    assert alive(session, 1.0) == {}


@pytest.mark.parametrize("attack", ["foreign", "expired", "plain", "no certificate"])
def test_refused_at_the_handshake(rig, tmp_path, attack):
    if attack == "foreign":
        make_authority(tmp_path / "other")
        session = rig.connect(issue(tmp_path / "other", "operator", "alice", ["ur5"]), checked=False)
    elif attack == "expired":
        session = rig.connect(issue(rig.folder, "operator", "late", ["ur5"], days=-1), checked=False)
    elif attack == "plain":
        session = open_session([rig.operator_side.replace("tls/", "tcp/")])
        rig.sessions.append(session)
    else:
        ca = str(rig.folder / "ca.pem")
        extra = [("transport/link/tls/root_ca_certificate", ca)]
        session = open_session([rig.operator_side], extra=extra)
        rig.sessions.append(session)
    session.put(COMMAND, b"attack")
    assert not meet(session, 1.0)
    assert b"attack" not in {p.payload for p in rig.proxy.operator_link.receive()}


def test_a_link_that_closes_because_a_certificate_ends_is_told_at_both_ends(rig):
    short = load_folder(issue(rig.folder, "operator", "short", ["ur5"], days=3.0 / 86_400.0))
    server = load_folder(rig.folder / "netem.lab")
    assert any("operator.short" in line and "less than an hour" in line for line in server.warnings)
    endpoint = f"tls/127.0.0.1:{free_ports(1)[0]}"
    there = open_session(listen=[endpoint], extra=server.settings("netem-operator"))
    here = open_session([endpoint], extra=short.settings("operator"))
    rig.sessions += [here, there]
    said = [threading.Event(), threading.Event()]
    ended = "certificate 'operator.short' has ended"
    watches = [
        watch_names(session, folder, place, lambda line, event=event: ended in line and event.set())
        for session, folder, place, event in (
            (here, short, "operator", said[0]),
            (there, server, "netem-operator", said[1]),
        )
    ]
    assert all(event.wait(PATIENCE) for event in said)
    # It is said while the link is being taken down: Zenoh still lists it for a moment.
    pause = threading.Event()
    for _ in range(round(PATIENCE / 0.05)):
        if not list(here.info.peers_zid()):
            break
        pause.wait(0.05)
    assert not meet(here, 0.5)
    del watches


def test_a_server_with_another_hosts_certificate_is_not_trusted(rig, tmp_path):
    """Right authority, wrong name: whoever stole a robot's certificate cannot play the emulator elsewhere."""
    alice = rig.connect(
        rig.folder / "operator.alice", endpoint=rig.operator_side.replace("127.0.0.1", "127.0.0.2")
    )
    assert not meet(alice, 1.5)


def test_the_doctor_sees_wrong_certificates(rig, tmp_path):
    scenario = load_scenario("point-obstacle")
    make_authority(tmp_path / "other")
    foreign = issue(tmp_path / "other", "operator", "alice", ["ur5"])
    found = examine(rig.operator_side, "ur5", str(foreign), scenario, 1)
    assert (found[-1].level, found[-1].what) == ("bad", "TLS")
    found = examine(rig.operator_side.replace("tls", "tcp"), "ur5", "", scenario, 1)
    assert (found[-1].level, found[-1].what) == ("bad", "Zenoh")
    found = examine(rig.operator_side, "ur5", str(rig.folder / "operator.alice"), scenario, 1)
    assert ("good", "TLS") in {(f.level, f.what) for f in found}
    assert (found[-1].level, found[-1].what) == ("bad", "robot")


def test_the_doctor_thinks_of_the_clock_where_a_date_is_wrong(rig, monkeypatch):
    """Ours has ended for the other side; the other's has ended, or begins in the future, for us."""
    ended = issue(rig.folder, "operator", "ended", ["ur5"], days=-1)
    own = read_certificate(ended / "cert.pem")
    found = probe_tls(rig.operator_side, TlsFolder(ended, own, own, (), ()))
    assert found.level == "bad"
    assert "clock of the host there" in found.remedy
    alice = load_folder(rig.folder / "operator.alice")
    with tls_server(issue(rig.folder, "router", "nearly", days=5)) as endpoint:
        found = probe_tls(endpoint, alice)
    assert (found.level, found.what) == ("note", "TLS")
    assert "router.nearly has 5 days left" in found.found
    assert "renew router.nearly" in found.remedy
    server = issue(rig.folder, "netem", "old", days=-1)
    with tls_server(server) as endpoint:
        found = probe_tls(endpoint, alice)
    assert (found.level, found.what) == ("bad", "TLS")
    assert "this host's clock" in found.remedy
    monkeypatch.setattr("farhand.common.trust.certificate.utc_seconds", lambda: 0.0)
    found, *more = examine(rig.operator_side, "ur5", str(alice.path), load_scenario("point-obstacle"), 1)
    assert not more
    assert found.level == "bad"
    assert "not valid before" in found.found
    assert "clock" in found.remedy


def test_through_a_router_with_the_printed_configuration(rig):
    """operator -> router -> robot, all with TLS and access control."""
    issue(rig.folder, "router", "hub")
    for name in ("operator.alice", "robot.ur5"):
        assert (rig.folder / name / "members" / "router.hub.pem").exists()
    endpoint = f"tls/127.0.0.1:{free_ports(1)[0]}"
    extra = load_folder(rig.folder / "router.hub", "router").settings("router")
    router = open_session(listen=[endpoint], mode="router", extra=extra)
    extra = load_folder(rig.folder / "robot.ur5").settings("robot")
    robot = open_session([endpoint], mode="client", extra=extra)
    alice = rig.connect(rig.folder / "operator.alice", endpoint=endpoint, mode="client")
    bob = rig.connect(rig.folder / "operator.bob", checked=False, endpoint=endpoint, mode="client")
    rig.sessions += [robot, router]
    payloads = []
    moved = threading.Event()

    def take(sample: zenoh.Sample):
        payloads.append(sample.payload.to_bytes())
        if payloads[-1] == b"lawful":
            moved.set()

    robot.declare_subscriber(COMMAND, take)
    assert put_until(lambda: (bob.put(COMMAND, b"attack"), alice.put(COMMAND, b"lawful")), moved)
    state, stolen = received(alice, STATE), received(bob, STATE)
    assert put_until(lambda: robot.put(STATE, b"s"), state)
    assert b"attack" not in payloads
    assert not stolen.is_set()
