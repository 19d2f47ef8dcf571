"""A console with an operator's program that always answers, and a browser before it."""

import asyncio
import socket
import threading

import uvicorn

from farhand.common.timing.clock import to_ns
from farhand.operator_side.console.console import Console
from farhand.operator_side.console.server import Door, Server, build_of
from farhand.operator_side.console.web import web_config
from tests.operator_side.console.browser import Browser
from tests.operator_side.console.operator import Operator
from tests.operator_side.console.wire import Wire

PATIENCE = 30.0
ROUND = 0.005
HEEDS = """
window.doneAt = null;
for (const kind of ['keyup', 'pointerup', 'blur'])
  addEventListener(kind, () => window.doneAt ??= performance.timeOrigin + performance.now(), {capture: true});
"""
NOW = "window.doneAt = performance.timeOrigin + performance.now();"


class Desk:
    """A console with an operator's program that always answers, on loopback."""

    def __init__(self, operator=None, find_model=lambda _: None, network=None):
        self.operator, self.pause = operator or Operator(), threading.Event()
        self.held_up = 0.0  # the longest round of the last `until`, beyond what it waits (s)
        self.bound = socket.create_server(("127.0.0.1", 0))
        self.wire = Wire(self.bound.getsockname()[1])
        host = f"127.0.0.1:{self.wire.port}"
        door = Door(hosts=frozenset({host}), build=build_of())
        self.console = Console("r", self.operator, 5, find_model, network)
        server = Server(self.console, door, self.operator.clock.now_ns, lambda line: None)
        self.server, self.url = uvicorn.Server(web_config(server.app)), f"http://{host}/"
        serve = self.server.serve(sockets=[self.bound])
        self.thread = threading.Thread(target=lambda: asyncio.run(serve), daemon=True)
        self.thread.start()
        self.browser = Browser()

    def until(self, holds, what, patience=PATIENCE):
        begun_ns = round_ns = self.operator.clock.now_ns()
        self.held_up = 0.0
        while round_ns < begun_ns + to_ns(patience):
            if holds():
                return
            self.pause.wait(ROUND)
            before_ns, round_ns = round_ns, self.operator.clock.now_ns()
            self.held_up = max(self.held_up, (round_ns - before_ns) * 1e-9 - ROUND)
        raise AssertionError(f"not within {patience:g} s: {what}")

    @property
    def engaged(self):
        return bool(self.operator.told) and self.operator.told[-1].engaged

    def sits_down(self):
        self.browser.cdp("Page.bringToFront")  # a gamepad is a matter of who has the focus
        self.browser.open(self.url)
        self.until(lambda: self.browser.text("driver") == "you drive", "the page drives")
        self.until(self.counts, "what the page says counts")
        return self

    def counts(self):
        seat = self.console.seat
        return seat.counts(seat.driver, self.operator.clock.now_ns())

    def presses(self, code="KeyW"):
        """A key that engages."""
        return self.begins(lambda: self.browser.key(code), lambda: self.browser.key(code, down=False))

    def begins(self, press, let_go):
        """A press that engages; again, as a person would, where a busy machine had the page just then late."""
        for _ in range(8):
            press()
            deadline_ns = self.operator.clock.now_ns() + to_ns(1.0)
            while self.operator.clock.now_ns() < deadline_ns:
                if self.engaged:
                    return self
                self.pause.wait(0.005)
            let_go()
            if self.console.seat.driver == 0:
                self.browser.click("#seat")  # a page that was not heard for long drives no more
                self.until(self.counts, "it drives again")
        raise AssertionError(f"no press engages: {self.browser.text('sentence')}")

    def sits(self):
        """Whether the page that is open drives, with nothing held down."""
        drives = self.counts() and not self.engaged and not self.console.seat.locked
        return (
            drives and self.browser.run("return document.getElementById('driver')?.innerText") == "you drive"
        )

    def lets_go_after(self, deed, by_page=False):
        """How long the operator's program was told to move after a deed (s).

        From when the page was handed it, with `by_page`: the script that drives a busy browser is heard later, and
        the browser may keep an input before the page has it (0.4 s seen under load). Less what this very loop was
        held up: a processor that others had is not what is looked at.
        """
        if by_page:
            self.browser.run(HEEDS)
        began = len(self.operator.told)
        done_ns = self.operator.clock.now_ns()
        deed()
        self.until(lambda: not self.engaged, "it lets go")
        if by_page:
            done_ns = round(self.browser.run("return window.doneAt") * 1e6) - self.operator.clock.epoch_ns()
        told = zip(self.operator.told_ns[began:], self.operator.told[began:], strict=False)
        took = (max((at for at, said in told if said.engaged), default=done_ns) - done_ns) * 1e-9
        return took if took < 0 else max(0.0, took - self.held_up)

    def stays_still(self, seconds=0.6):
        began = len(self.operator.told)
        self.pause.wait(seconds)
        assert not any(said.engaged for said in self.operator.told[began:])

    def close(self):
        self.browser.close()
        self.server.should_exit = True
        self.wire.close()
        self.thread.join(5)
        self.bound.close()
