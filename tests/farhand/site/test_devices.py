"""`farhand devices`: what is there, what it shows, and what to do where there is nothing."""

import io
import json
import threading

import pytest
from rich.console import Console

from farhand.cli import run
from farhand.operator_side.devices import sources
from farhand.operator_side.devices.reading import Reading
from farhand.site import devices

ROW = {"name": "Pad", "kind": "gamepad", "mapping": "SDL", "axes": 6, "buttons": None, "hats": 0}
PUSHED = {"axis0": -0.5, "leftx": -0.5, "righttrigger": 1.0, "a": 1.0, "b": 0.0, "button0": 1.0}


class Fake:
    """A place for a gamepad, in which readings come one after the other."""

    def __init__(self, readings=(), stop=None):
        self.readings, self.stop, self.trouble, self.closed = list(readings), stop, "", False

    def __call__(self, _name):
        return self

    def found(self):
        return [ROW] if self.readings else []

    def read(self, _now_ns):
        if len(self.readings) == 1 and self.stop is not None:
            self.stop.set()
        return self.readings.pop(0) if self.readings else None

    def close(self):
        self.closed = True


def reading(inputs, mapped=True):
    return Reading("Pad", 1, inputs, 0, mapped)


@pytest.fixture
def there(monkeypatch):
    def put(*readings):
        stop = threading.Event()
        fake = Fake(readings, stop)
        monkeypatch.setattr(devices, "SOURCES", {"gamepad": fake})
        monkeypatch.setattr(devices, "stop_event_on_signals", lambda: stop)
        return fake

    return put


def test_a_table_and_json(there, capsys):
    fake = there(reading(PUSHED))
    assert run(["devices"]) == 0
    assert fake.closed
    out = capsys.readouterr().out
    assert all(word in out for word in ("Pad", "gamepad", "SDL", "6", "?"))
    assert run(["devices", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"devices": [ROW], "lacking": {}}


def test_nothing_is_said_with_what_to_do(there, capsys):
    there()
    assert run(["devices"]) == 1
    assert "plug in a gamepad" in capsys.readouterr().out


def test_a_library_that_is_not_installed_is_named_by_its_extra(there, capsys, monkeypatch):
    monkeypatch.setattr(sources.importlib.util, "find_spec", lambda _name: None)
    there()
    assert run(["devices"]) == 1
    assert "farhand[gamepad]" in capsys.readouterr().out
    assert run(["demo", "--steer", "gamepad"]) == 2
    assert run(["demo", "--steer", "spacemouse"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert ["farhand[gamepad]" in said[0], "farhand[spacemouse]" in said[1], len(said)] == [True, True, 2]


def test_in_a_pipe_each_change_is_a_line(there, capsys):
    there(reading(PUSHED), reading(PUSHED), reading(PUSHED | {"a": 0.0, "button0": 0.0}), None)
    assert run(["devices", "--watch"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("gamepad:")]
    assert lines == [
        "gamepad: Pad: leftx -0.50 righttrigger +1.00  pressed: a button0",
        "gamepad: Pad: leftx -0.50 righttrigger +1.00  pressed: nothing",
        "gamepad: none",
    ]


def test_lines_of_json(there, capsys):
    there(reading(PUSHED), None)
    assert run(["devices", "--watch", "--json"]) == 0
    _, first, second = map(json.loads, capsys.readouterr().out.splitlines())
    assert first == {"kind": "gamepad", "device": "Pad", "mapped": True, "inputs": PUSHED}
    assert second == {"kind": "gamepad", "device": None, "why": "none"}


def test_a_terminal_sees_bars_and_a_device_without_a_mapping_its_raw_names():
    console = Console(file=io.StringIO(), width=80)
    console.print(
        devices.drawn({"gamepad": reading({"axis0": -1.0, "axis1": 1.0, "button3": 1.0}, False), "x": "none"})
    )
    lines = console.file.getvalue().splitlines()
    assert lines[1].startswith("axis0  █·")
    assert "·█  +1.00" in lines[2]
    assert "pressed: button3" in lines[3]
    assert "x: none" in lines[4]
