"""`farhand devices`: what is plugged in on this host that could steer, and what it shows."""

import json
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import ExitStack

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from farhand.common.process.console import page, whole
from farhand.common.process.signals import stop_event_on_signals
from farhand.common.timing.clock import SystemClock
from farhand.operator_side.devices.reading import Reading, Source
from farhand.operator_side.devices.sources import SOURCES, lacking
from farhand.operator_side.steering.hand.gamepad import STICKS
from farhand.operator_side.steering.hand.spacemouse import CAP_AXES

PERIOD = 0.05
NOTHING = (
    "no device is found; plug in a gamepad or a SpaceMouse. One that is plugged in and not listed: who runs this needs "
    "the right to read /dev/input and /dev/hidraw*, and in a container the host's /dev and /run/udev must be there"
)
PRESSED = 0.5
_BAR = 20
_NAMED_AXES, _RAW_AXES = frozenset((*STICKS, *CAP_AXES)), ("axis", "hat")


def list_devices(*, watch: bool, as_json: bool) -> int:
    """Print what is there, and with `watch` what it shows, until Ctrl-C; returns 0, or 1 where nothing is there."""
    lacks = {kind: line.partition(": ")[2] for kind in SOURCES if (line := lacking(kind))}
    with ExitStack() as closing:
        sources: dict[str, Source] = {}
        for kind, make in SOURCES.items():
            if kind not in lacks:
                sources[kind] = make("")
                closing.callback(sources[kind].close)
        found = [row for source in sources.values() for row in source.found()]
        if as_json:
            print(json.dumps({"devices": found, "lacking": lacks}), flush=True)
        else:
            _print_found(found, lacks)
        if watch:
            _watch(sources, stop_event_on_signals(), as_json)
            return 0
        return 0 if found else 1


def _print_found(found: list[dict[str, object]], lacks: Mapping[str, str]) -> None:
    console = page(emoji=False)
    if found:
        columns = ("name", "kind", "mapping", "axes", "buttons", "hats")
        table = Table(*columns)
        for row in found:
            table.add_row(*("?" if row[name] is None else Text(str(row[name])) for name in columns))
        console.print(whole(table, console))
    else:
        console.print(NOTHING, soft_wrap=True, highlight=False, markup=False)
    for kind, line in lacks.items():
        console.print(f"{kind}: {line}", soft_wrap=True, highlight=False, markup=False)


def _watch(sources: Mapping[str, Source], stop_event: threading.Event, as_json: bool) -> None:
    clock, console = SystemClock(), Console(file=sys.stdout)
    if console.is_terminal and not as_json:
        with Live(console=console, auto_refresh=False, transient=True) as live:
            _each(sources, stop_event, clock, lambda shown: live.update(drawn(shown), refresh=True))
        return
    said: dict[str, str] = {}

    def print_new(shown: Mapping[str, Reading | str]) -> None:
        for kind, reading in shown.items():
            line = _as_json(kind, reading) if as_json else _line(kind, reading)
            if said.get(kind) != line:
                said[kind] = line
                print(line, flush=True)

    _each(sources, stop_event, clock, print_new)


def _each(
    sources: Mapping[str, Source],
    stop_event: threading.Event,
    clock: SystemClock,
    show: Callable[[Mapping[str, Reading | str]], None],
) -> None:
    while not stop_event.is_set():
        show(
            {
                kind: source.read(clock.now_ns()) or source.trouble or "none"
                for kind, source in sources.items()
            }
        )
        stop_event.wait(PERIOD)


def shown_inputs(reading: Reading) -> tuple[dict[str, float], list[str]]:
    """The axes, by their names where they have some, and all that is pressed, by every name that it has."""
    named = {name: value for name, value in reading.inputs.items() if name in _NAMED_AXES}
    raw = {name: value for name, value in reading.inputs.items() if name.startswith(_RAW_AXES)}
    pressed = [name for name, value in reading.inputs.items() if name not in named | raw and value > PRESSED]
    return named or raw, pressed


def drawn(shown: Mapping[str, Reading | str]) -> Group:
    """What is shown at one instant, for a terminal; text says why there is no reading of a kind."""
    parts: list[Table | Text] = []
    for kind, reading in shown.items():
        if isinstance(reading, str):
            parts.append(Text(f"{kind}: {reading}", style="dim"))
            continue
        axes, pressed = shown_inputs(reading)
        grid = Table.grid(padding=(0, 2))
        for name, value in axes.items():
            place = round((value + 1.0) / 2.0 * _BAR)
            grid.add_row(name, "·" * place + "█" + "·" * (_BAR - place), f"{value:+.2f}")
        parts += [
            Text(reading.device, style="bold"),
            grid,
            Text(f"pressed: {' '.join(pressed) or 'nothing'}"),
        ]
    return Group(*parts, Text("Ctrl-C ends it", style="dim"))


def _line(kind: str, reading: Reading | str) -> str:
    if isinstance(reading, str):
        return f"{kind}: {reading}"
    axes, pressed = shown_inputs(reading)
    values = " ".join(f"{name} {value:+.2f}" for name, value in axes.items())
    return f"{kind}: {reading.device}: {values}  pressed: {' '.join(pressed) or 'nothing'}"


def _as_json(kind: str, reading: Reading | str) -> str:
    if isinstance(reading, str):
        return json.dumps({"kind": kind, "device": None, "why": reading})
    inputs = {name: round(value, 3) for name, value in reading.inputs.items()}
    return json.dumps({"kind": kind, "device": reading.device, "mapped": reading.mapped, "inputs": inputs})
