"""The console's program beyond loopback: who is let in over TLS, with a token, under its own name, and who is not."""

import base64
import http.client
import socket
import ssl
import threading
from contextlib import ExitStack

import pytest
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from farhand.common.errors import InputError
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import steering_key
from farhand.operator_side.console import server
from farhand.programs.command_line import ConsoleWords
from farhand.programs.console import ConsoleOptions, console_program
from farhand.site.certificates import issue, make_authority
from farhand.testing import Programs
from tests.operator_side.console.browser import CHROMIUM, DRIVER, Browser
from tests.operator_side.console.caller import Caller
from tests.operator_side.console.operator import Operator

TOKEN = "a long enough word"


class Console:
    """The program with TLS and a token, and an operator's program that it hears."""

    def __init__(self, folder):
        make_authority(folder / "ca")
        tls = issue(folder / "ca", "operator", "anna", robots=["r"])
        report, page = free_ports(2)
        endpoint, self.host = f"tcp/127.0.0.1:{report}", f"127.0.0.1:{page}"
        self.operator, self.stop = Operator(), threading.Event()
        self.link = ZenohLink(open_session((), [endpoint]), [steering_key("r")], self.operator.clock)
        self.programs = Programs(folder)
        words = ConsoleWords(connect=endpoint, listen=self.host, robot="r", token=TOKEN, tls=str(tls))
        self.programs.start(*words.words())
        self.secure = ssl.create_default_context(cafile=folder / "ca" / "ca.pem")
        self.thread = threading.Thread(target=self._publish, daemon=True)
        self.thread.start()
        for _ in range(200):
            try:
                socket.create_connection(("127.0.0.1", page), 1).close()
                break
            except OSError:
                self.stop.wait(0.05)

    def _publish(self):
        while not self.stop.wait(0.03):
            for packet in self.operator.receive():
                self.link.send(packet)
            for packet in self.link.receive():
                self.operator.send(packet)

    def close(self):
        self.stop.set()
        self.thread.join(2)
        self.programs.close()
        self.link.close()


@pytest.fixture(scope="module")
def console(tmp_path_factory):
    console = Console(tmp_path_factory.mktemp("console"))
    yield console
    console.close()


@pytest.mark.realtime
@pytest.mark.parametrize("token", ["", "wrong", TOKEN[:-1]])
def test_a_wrong_or_missing_token_is_refused_and_told_so(console, token):
    with Caller(console.host, token, console.secure) as caller, pytest.raises(ConnectionClosed) as ended:
        caller.hear("frame")
    assert ended.value.rcvd.code == server.REFUSED
    assert "token" in ended.value.rcvd.reason


@pytest.mark.realtime
@pytest.mark.parametrize(("origin", "status"), [("https://evil.example", 403), ("null", 403), ("", 101)])
def test_a_page_of_another_origin_is_refused(console, origin, status):
    """By hand: at times websockets' client waits in vain for an answer whose end it had with it."""
    host, port = console.host.split(":")
    asked = http.client.HTTPSConnection(host, int(port), context=console.secure, timeout=5)
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    key = {
        "Sec-WebSocket-Key": base64.b64encode(bytes(16)).decode(),
        "Origin": origin or f"https://{console.host}",
    }
    asked.request("GET", "/socket", headers=upgrade | key)
    assert asked.getresponse().status == status
    asked.close()


@pytest.mark.realtime
def test_another_name_for_the_same_address_gets_nothing(console):
    """As after DNS rebinding: a stranger's name that leads here."""
    host, port = console.host.split(":")
    asked = http.client.HTTPSConnection(host, int(port), context=console.secure, timeout=5)
    asked.request("GET", "/", headers={"Host": f"evil.example:{port}"})
    answer = asked.getresponse()
    assert answer.status == 421
    assert b"<script" not in answer.read()
    asked.close()


@pytest.mark.realtime
def test_plain_http_is_not_answered(console):
    with pytest.raises((InvalidHandshake, OSError, ConnectionClosed)):
        Caller(console.host, TOKEN)
    host, port = console.host.split(":")
    asked = http.client.HTTPConnection(host, int(port), timeout=5)
    asked.request("GET", "/")
    with pytest.raises((http.client.HTTPException, OSError)):
        asked.getresponse()
    asked.close()


@pytest.mark.realtime
def test_a_caller_with_the_token_drives_and_strangers_that_only_connect_do_not_keep_others_out(console):
    host, port = console.host.split(":")
    with ExitStack() as closing:
        idle = [closing.enter_context(socket.create_connection((host, int(port)))) for _ in range(60)]
        idle[0].send(b"\x16\x03\x01 no TLS")
        caller = closing.enter_context(Caller(console.host, TOKEN, console.secure))
        caller.hear("frame", lambda told: not told["locked"])
        caller.says(kind="do", what="take")
        told = {"counts": False}
        while not told["counts"]:  # a page goes on speaking, or is taken for asleep
            caller.steer(console.operator.clock.now_ns())
            told = caller.hear("frame")
        caller.steer(console.operator.clock.now_ns(), engaged=True, press=1)
        caller.hear("frame", lambda told: any(said.engaged for said in console.operator.told))


@pytest.mark.realtime
@pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="needs Debian's packages chromium and chromium-driver")
def test_a_page_over_tls_and_without_webgl_drives(console):
    browser = Browser(flags=["--ignore-certificate-errors", "--disable-3d-apis"])
    try:
        browser.open(f"https://{console.host}/#{TOKEN.replace(' ', '%20')}")
        for _ in range(200):
            if browser.text("driver") == "you drive" and browser.text("pill").lower() == "ready":
                break
            console.stop.wait(0.05)
        assert browser.run("return document.createElement('canvas').getContext('webgl2')") is None
        began = len(console.operator.told)
        for _ in range(8):
            browser.key("KeyW")
            console.stop.wait(0.3)
            browser.key("KeyW", down=False)
            if any(said.engaged for said in console.operator.told[began:]):
                return
        raise AssertionError(f"no press engages: {browser.text('sentence')}")
    finally:
        browser.close()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"listen": "10.0.0.5:8080"}, "needs --token WORD and --tls DIR"),
        ({"listen": "0.0.0.0:8080", "token": TOKEN}, "needs --token WORD and --tls DIR"),
        ({"listen": "8080"}, "expected HOST:PORT"),
        ({"listen": "127.0.0.1:99999"}, "expected HOST:PORT"),
        ({"tls": "/nowhere"}, "/nowhere"),
        ({"netem": "tcp/10.0.0.5:7449"}, "this host only"),
        ({"netem": "nonsense"}, "nonsense"),
    ],
)
def test_what_would_let_strangers_in_is_refused_in_one_line(options, words):
    options = {"robot": "r", "connect": "tcp/127.0.0.1:7446"} | options
    with pytest.raises(InputError) as refused:
        console_program(ConsoleOptions(**options))
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_short_token_beyond_this_host_is_refused(tmp_path):
    make_authority(tmp_path / "ca")
    tls = str(issue(tmp_path / "ca", "operator", "anna", robots=["r"]))
    options = ConsoleOptions(
        robot="r", connect="tcp/127.0.0.1:7446", listen="10.0.0.5:8080", token="x", tls=tls
    )
    with pytest.raises(InputError, match="8 characters"):
        console_program(options)
