"""What a SpaceMouse reports over HID, as axes of whoever sits behind the robot: x ahead, y to the left, z up.

The device's own are x to the right, y back and z down, so that two change places and all change signs, of the
turns alike. A report is its number and little-endian 16-bit integers, or the bits of buttons.
"""

from collections.abc import MutableMapping

TRANSLATION, ROTATION, BUTTONS = 1, 2, 3
FULL = 350.0
"""A cap's end of travel, in counts."""
MOST_BUTTONS = 48
_MOVES, _TURNS = ("capy", "capx", "capz"), ("cappitch", "caproll", "capyaw")


def at_rest() -> dict[str, float]:
    """All inputs before the first report."""
    return dict.fromkeys((*_MOVES, *_TURNS), 0.0) | {f"button{n}": 0.0 for n in range(2)}


def take_report(report: bytes, inputs: MutableMapping[str, float]) -> None:
    """Note what a report says; what is none is left out."""
    if not report:
        return
    number, body = report[0], report[1:]
    if number == TRANSLATION:
        _take_axes(body[:6], _MOVES, inputs)
        _take_axes(body[6:12], _TURNS, inputs)
    elif number == ROTATION:
        _take_axes(body[:6], _TURNS, inputs)
    elif number == BUTTONS:
        bits = int.from_bytes(body[: MOST_BUTTONS // 8], "little")
        for n in range(min(MOST_BUTTONS, 8 * len(body))):
            inputs[f"button{n}"] = float(bits >> n & 1)


def _take_axes(body: bytes, names: tuple[str, ...], inputs: MutableMapping[str, float]) -> None:
    if len(body) < 6:
        return
    for n, name in enumerate(names):
        counts = int.from_bytes(body[2 * n : 2 * n + 2], "little", signed=True)
        inputs[name] = max(-1.0, min(1.0, -counts / FULL))
