"""The server without a browser: who is let in, what a page sees, what reaches the operator's program."""

import msgspec
import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from farhand.operator_side.console import server as module
from farhand.operator_side.console.console import Console
from farhand.operator_side.console.server import Door, Server
from tests.operator_side.console.operator import Operator

HOST = "127.0.0.1:8080"
ORIGIN = {"origin": f"http://{HOST}", "host": HOST}


@pytest.fixture
def operator():
    return Operator()


@pytest.fixture
def client(operator):
    said = []
    console = Console("r", operator, 5)
    door = Door(hosts=frozenset({HOST}), token="word", build="b1")
    with TestClient(
        Server(console, door, operator.clock.now_ns, said.append).app, f"http://{HOST}"
    ) as client:
        client.said = said
        yield client


def page(client, headers=ORIGIN):
    return client.websocket_connect("/socket", headers=headers)


def say(socket, **message):
    socket.send_bytes(msgspec.msgpack.encode(message))


def hear(socket, kind, holds=lambda told: True):
    """The next message of a kind of which it holds."""
    for _ in range(300):
        told = msgspec.msgpack.decode(socket.receive_bytes())
        if told["kind"] == kind and holds(told):
            return told
    raise AssertionError(f"no {kind} of which it holds")


def enter(socket):
    say(socket, kind="hello", page="b1", token="word")


def test_a_page_sees_robot_scene_and_frames(client):
    with page(client) as socket:
        enter(socket)
        assert hear(socket, "robot")["model"] == "ur5"
        assert hear(socket, "scene")["obstacles"][0]["shape"] == {"kind": "sphere", "radius": 0.07}
        told = hear(socket, "frame", lambda told: told["state"] is not None)
        assert [point[0] for point in told["path"]] == pytest.approx([0.0, 0.01, 0.02])
        assert told["age"] < 1.0


def test_a_press_reaches_the_operator_and_the_end_of_the_page_lets_go(client, operator):
    with page(client) as socket:
        enter(socket)
        hear(socket, "frame", lambda told: not told["locked"])
        say(socket, kind="do", n=1, what="take")
        hear(socket, "frame", lambda told: told["driver"] == told["you"])
        say(socket, kind="steer", n=2, t=0.0, engaged=False, press=0)
        began = hear(socket, "frame")["stamp"]
        told = hear(socket, "frame", lambda told: told["stamp"] > began + 350)
        say(
            socket,
            kind="steer",
            n=3,
            t=told["stamp"] - began,
            engaged=True,
            press=1,
            linear=(0.0, 1.0, 0.0),
            scale=0.6,
            seen=told["stamp"],
        )
        told = hear(socket, "frame", lambda told: told["heard"] == 1)
        assert told["you"] == 1
        pressed = [each for each in operator.told if each.engaged]
        assert (pressed[0].linear, pressed[0].scale, pressed[0].press) == ((0.0, 1.0, 0.0), 0.6, 1)
        hear(socket, "frame", lambda told: not told["holds"])  # it said no more
        assert not operator.told[-1].engaged
    with page(client) as socket:
        enter(socket)
        hear(socket, "frame", lambda told: told["driver"] == 0)
    assert any(each.release for each in operator.told)


def test_an_emergency_stop_reaches_the_operator_from_a_page_that_watches(client, operator):
    with page(client) as socket:
        enter(socket)
        say(socket, kind="do", n=1, what="estop")
        hear(socket, "frame", lambda told: any(each.estop for each in operator.told))


def test_a_silent_operator_locks(client, operator):
    with page(client) as socket:
        enter(socket)
        hear(socket, "frame", lambda told: not told["locked"])
        operator.silent = True
        told = hear(socket, "frame", lambda told: told["locked"])
        assert told["reasons"][0]["pill"] == "link lost"
        assert told["reasons"][0]["clears"]


@pytest.mark.parametrize(
    "headers",
    [
        {"host": HOST},
        {**ORIGIN, "origin": "http://evil.example"},
        {**ORIGIN, "origin": "null"},
        {**ORIGIN, "host": "evil.example"},
    ],
)
def test_other_origins_are_refused(client, headers):
    with pytest.raises(WebSocketDisconnect), page(client, headers):
        pass


@pytest.mark.parametrize(
    ("first", "code"),
    [
        ({"kind": "hello", "page": "b1", "token": "wrong"}, module.REFUSED),
        ({"kind": "hello", "page": "b0", "token": "word"}, module.TOO_OLD),
        ({"kind": "do", "n": 1, "what": "estop"}, module.UNREADABLE),
        ({"kind": "nonsense"}, module.UNREADABLE),
    ],
)
def test_who_does_not_greet_properly_is_told_why(client, first, code):
    with page(client) as socket:
        say(socket, **first)
        with pytest.raises(WebSocketDisconnect) as ended:
            socket.receive_bytes()
        assert ended.value.code == code
        assert ended.value.reason


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xc1",
        b"x" * 5000,
        msgspec.msgpack.encode({"kind": "steer", "n": 1, "t": 0.0, "engaged": True, "press": 1, "linear": [9, 0, 0]}),
        msgspec.msgpack.encode({"kind": "steer", "n": 1, "t": float("nan"), "engaged": True, "press": 1}),
    ],
)  # fmt: skip
def test_what_is_no_message_ends_a_page(client, operator, payload):
    with page(client) as socket:
        enter(socket)
        hear(socket, "frame")
        socket.send_bytes(payload)
        with pytest.raises(WebSocketDisconnect) as ended:
            hear(socket, "nothing")
        assert ended.value.code == module.UNREADABLE
    assert not any(each.engaged for each in operator.told)


def test_files_come_with_a_policy_and_nothing_else_comes(client):
    for name in ("../server.py", "built.json", "nothing.js"):
        assert client.get(f"/{name}").status_code == 404
    assert client.get("/robot/model.urdf").status_code == 404
    assert client.get("/", headers={"host": "evil.example"}).status_code == 421
    assert "default-src 'none'" in client.get("/nothing.js").headers["content-security-policy"]
