"""The server without a browser: who is let in, what a page sees, what reaches the operator's program."""

from contextlib import ExitStack

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from farhand.common.messages.scene import Obstacle
from farhand.operator_side.console import server as module
from farhand.operator_side.console.console import Console
from farhand.operator_side.console.network import NetworkTold
from farhand.operator_side.console.server import Door, Server
from tests.operator_side.console.operator import Operator, frame

HOST = "127.0.0.1:8080"
ORIGIN = {"origin": f"http://{HOST}", "host": HOST}
PRESSES = 8


@pytest.fixture
def operator():
    return Operator()


def served(operator, network=None):
    console = Console("r", operator, 5, network=network)
    door = Door(hosts=frozenset({HOST}), token="word", build="b1")
    server = Server(console, door, operator.clock.now_ns, lambda line: None)
    return TestClient(server.app, f"http://{HOST}")


@pytest.fixture
def client(operator):
    with served(operator) as client:
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


def take(socket):
    say(socket, kind="do", n=0, what="take")
    hear(socket, "frame", lambda told: told["driver"] == told["you"])


almost = st.builds(
    lambda message, cut: msgspec.msgpack.encode(message)[cut:],
    st.fixed_dictionaries(
        {"kind": st.sampled_from(["steer", "do", "network", "outage", "hello", "x"]), "n": st.integers(0, 9)},
        optional={
            "t": st.floats(),
            "engaged": st.just(True),
            "press": st.integers(-1, 9),
            "linear": st.lists(st.floats(-2, 2), max_size=4),
            "what": st.sampled_from(["release", "give", "x"]),
            "seconds": st.floats(),
            "name": st.text(max_size=9),
        },
    ),
    st.sampled_from([0, 0, 0, 1, 7]),
)
"""Messages that nearly are some, or are: of a page whose first steer does not count."""


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
    def took(press):  # an earlier one, that came too late, may reach the operator after all
        return [each for each in operator.told if each.engaged and each.press == press]

    def took_or_late(told):  # a press that is not done is one that the console says came too late
        return took(told["heard"]) or not told["counts"]

    with page(client) as socket:
        enter(socket)
        hear(socket, "frame", lambda told: not told["locked"])
        say(socket, kind="do", n=1, what="take")
        hear(socket, "frame", lambda told: told["driver"] == told["you"])
        n, press, began = 2, 0, hear(socket, "frame")["stamp"]
        pressed = []
        while not pressed and press < PRESSES:  # again, as a person would, where a busy machine was late
            told = hear(socket, "frame")
            settled = told["stamp"] + 350
            while told["stamp"] <= settled:  # a page goes on speaking, or is taken for asleep
                say(socket, kind="steer", n=n, t=told["stamp"] - began, engaged=False, press=press)
                n, told = n + 1, hear(socket, "frame")
            press += 1
            say(
                socket,
                kind="steer",
                n=n,
                t=told["stamp"] - began,
                engaged=True,
                press=press,
                linear=(0.0, 1.0, 0.0),
                scale=0.6,
                seen=told["stamp"],
            )
            told = hear(
                socket, "frame", lambda told, press=press: told["heard"] == press and took_or_late(told)
            )
            n, pressed = n + 1, took(press)
        assert told["you"] == 1
        assert (pressed[0].linear, pressed[0].scale, pressed[0].press) == ((0.0, 1.0, 0.0), 0.6, press)
        hear(socket, "frame", lambda told: not told["holds"])  # it said no more
        hear(socket, "frame", lambda _: not operator.told[-1].engaged)  # with the console's next beat
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
        msgspec.msgpack.encode({"kind": "network", "n": 1, "name": "x" * 300}),
        msgspec.msgpack.encode({"kind": "outage", "n": 1, "seconds": 6.0}),
        msgspec.msgpack.encode({"kind": "hello", "page": "b1", "token": "word"}),
        b"\x91" * 4000,
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


def test_a_page_over_its_socket_gets_pictures_as_it_draws_them(client, operator):
    with page(client) as socket:
        enter(socket)
        assert hear(socket, "camera")["said"] == "no camera: no picture has come"
        operator.pictures = [frame(1)]
        assert hear(socket, "camera", lambda told: told["jpeg"])["jpeg"][-1] == 1
        operator.pictures = [frame(2)]
        say(socket, kind="pictured")
        told = hear(socket, "camera", lambda told: told["jpeg"])
        assert (told["jpeg"][-1], told["said"]) == (2, "")


@settings(max_examples=25)
@given(payloads=st.lists(st.one_of(st.binary(max_size=200), almost), min_size=1, max_size=5))
def test_whatever_bytes_come_nothing_moves_and_the_console_lives(payloads):
    operator = Operator()
    with served(operator) as client:
        with page(client) as socket:
            enter(socket)
            say(socket, kind="do", n=0, what="take")
            for payload in payloads:
                socket.send_bytes(payload)
        with page(client) as socket:
            enter(socket)
            hear(socket, "frame")
    assert not any(each.engaged for each in operator.told)


def test_a_flood_is_ended_and_the_driver_is_heard_all_the_while(client, operator):
    with page(client) as driver, page(client) as other:
        enter(driver)
        take(driver)
        enter(other)
        for n in range(1000):
            say(other, kind="steer", n=n, t=0.0, engaged=True, press=n)
        with pytest.raises(WebSocketDisconnect) as ended:
            hear(other, "nothing")
        assert ended.value.code == module.TOO_MANY
        told = hear(driver, "frame", lambda told: told["watching"] == 0)
        assert told["driver"] == told["you"]
    assert not any(each.engaged for each in operator.told)


def test_a_page_too_many_is_told_so_and_those_that_are_there_stay(client):
    with ExitStack() as closing:
        sockets = [closing.enter_context(page(client)) for _ in range(module.MOST_PAGES)]
        for socket in sockets:
            enter(socket)
            hear(socket, "frame")
        with page(client) as socket, pytest.raises(WebSocketDisconnect) as ended:
            socket.receive_bytes()
        assert ended.value.code == module.FULL
        assert "close one" in ended.value.reason
        hear(sockets[0], "frame", lambda told: told["watching"] == module.MOST_PAGES)


def test_a_scene_of_three_hundred_obstacles_comes_once_and_frames_go_on(client, operator):
    operator.obstacles = tuple(Obstacle(f"post-{k}", (0.5, 0.1 * k, 0.3), 0.05) for k in range(300))
    with page(client) as socket:
        enter(socket)
        assert len(hear(socket, "scene")["obstacles"]) == 300
        kinds = [msgspec.msgpack.decode(socket.receive_bytes())["kind"] for _ in range(30)]
        assert "scene" not in kinds
        operator.obstacles = operator.obstacles[:1]
        assert len(hear(socket, "scene")["obstacles"]) == 1


def test_a_second_driver_asks_and_gets_it_when_it_is_handed_over(client):
    with page(client) as first, page(client) as second:
        enter(first)
        take(first)
        enter(second)
        say(second, kind="do", n=1, what="take")
        told = hear(first, "frame", lambda told: told["asking"])
        assert told["driver"] == told["you"]
        say(first, kind="do", n=9, what="give", to=told["asking"][0][0])
        hear(second, "frame", lambda told: told["driver"] == told["you"])


class FakeNetwork:
    """An emulator as it answers: what it is told counts only once it says so."""

    def __init__(self):
        self.asked, self.answer = [], NetworkTold(("none", "constant:200"), "none", "none")

    def told(self):
        return self.answer

    def choose(self, name):
        self.asked.append(name)

    def cut(self, seconds):
        self.asked.append(seconds)


def test_who_drives_changes_the_network_and_what_is_shown_is_the_emulators_answer(operator):
    network = FakeNetwork()
    with served(operator, network) as client, page(client) as driver, page(client) as other:
        enter(driver)
        take(driver)
        enter(other)
        assert not hear(other, "frame", lambda told: told["driver"])["networks"]["changeable"]
        say(other, kind="network", n=1, name="constant:200")
        say(driver, kind="network", n=2, name="no such")
        say(driver, kind="network", n=3, name="constant:200")
        say(driver, kind="outage", n=4, seconds=2.0)
        told = hear(driver, "frame", lambda told: len(network.asked) == 2)
        assert network.asked == ["constant:200", 2.0]
        assert (told["networks"]["name"], told["networks"]["changeable"]) == ("none", True)
        network.answer = NetworkTold(("none",), "constant:200", "none", outage=True)
        told = hear(driver, "frame", lambda told: told["networks"]["outage"])
        assert told["networks"]["name"] == "constant:200 / none"
        network.answer = None
        hear(driver, "frame", lambda told: told["networks"] is None)


def test_what_a_page_loads_comes_compressed_to_those_who_take_it_so(client):
    whole = client.get("/page.js", headers={"accept-encoding": "identity", "host": HOST})
    small = client.get("/page.js", headers={"accept-encoding": "gzip, br", "host": HOST})
    never = client.get("/page.js", headers={"accept-encoding": "gzip;q=0", "host": HOST})
    assert small.headers["content-encoding"] == "gzip"
    assert "content-encoding" not in whole.headers
    assert "content-encoding" not in never.headers
    assert whole.content == small.content == never.content  # the client has unpacked it
    assert 3 * int(small.headers["content-length"]) < int(whole.headers["content-length"])
    for told in (whole, small):
        assert told.headers["vary"] == "Accept-Encoding"
        assert told.headers["content-type"].startswith("text/javascript")
        assert "default-src 'none'" in told.headers["content-security-policy"]


@pytest.mark.parametrize("path", ["/", "/page.js", "/robot/model.urdf"])
def test_another_name_of_this_host_gets_nothing(client, path):
    assert client.get(path, headers={"host": "evil.example:8080"}).status_code == 421
