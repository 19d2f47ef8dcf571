import io
import sys
import threading

from farhand.common.process.teller import WAITING_LINES, Teller


class SlowTerminal(io.StringIO):
    """Blocks whoever writes to it until it is released."""

    def __init__(self):
        super().__init__()
        self.free, self.reached, self.threads = threading.Event(), threading.Event(), set()

    def write(self, text):
        self.threads.add(threading.current_thread().name)
        self.reached.set()
        assert self.free.wait(10)
        return super().write(text)


def test_lines_are_said_elsewhere_and_those_that_find_no_place_are_counted(monkeypatch):
    terminal = SlowTerminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    teller = Teller("robot")
    teller.say("first")
    assert terminal.reached.wait(10)
    for number in range(WAITING_LINES + 7):
        teller.say(f"line {number}")  # would hang if it waited
    assert teller.lost == 7
    terminal.free.set()
    teller.close()
    lines = terminal.getvalue().splitlines()
    assert lines[:2] == ["robot: first", "robot: line 0"]
    assert lines[-1] == "robot: 7 more lines, faster than they could be written"
    assert len(lines) == WAITING_LINES + 2
    assert terminal.threads == {"teller"}


def test_a_terminal_that_is_gone_ends_nothing(monkeypatch):
    class Gone(io.StringIO):
        def write(self, text):
            raise BrokenPipeError(32, "Broken pipe")

    monkeypatch.setattr(sys, "stderr", Gone())
    teller = Teller("robot")
    teller.say("x")
    teller.say("y")
    teller.close()
    assert teller.lost == 0
