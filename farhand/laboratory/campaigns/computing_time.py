"""The modelled computing time of a control tick: a constant, or a measured distribution to draw from."""

import math
from pathlib import Path

from farhand.common.errors import InputError
from farhand.common.messages.codec import Decoder
from farhand.common.messages.report import ControlReport
from farhand.common.recording.reader import read_run

LONGEST = 10.0
MAX_SAMPLES = 100_000
EXPECTED = (
    "expected milliseconds such as 20, a recorded run (.mcap), or a text file with milliseconds, one a line"
)


def read_computing_time(text: str) -> tuple[float, ...]:
    """Seconds: one value is a constant, several are drawn from with replacement.

    Raises InputError with one clear line.
    """
    try:
        return (_checked(float(text), f"--computing-time {text!r}"),)
    except ValueError:
        pass
    path = Path(text)
    if not path.is_file():
        raise InputError(f"--computing-time {text!r}: no such file; {EXPECTED}")
    samples = _of_run(path) if path.suffix == ".mcap" else _of_text(path)
    if not samples:
        raise InputError(f"--computing-time {text}: holds no solve; {EXPECTED}")
    return tuple(samples[:MAX_SAMPLES])


def _of_run(path: Path) -> list[float]:
    """Solve times of a run in real time (s)."""
    decoder = Decoder(ControlReport)
    reports = [decoder.decode(tick.report) for tick in read_run(path).ticks]
    return [report.solve_time for report in reports if report is not None and report.solve_time > 0.0]


def _of_text(path: Path) -> list[float]:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"--computing-time {path}: cannot be read: {error}") from None
    samples = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        where = f"--computing-time {path}: line {number}: {line.strip()[:40]!r}"
        try:
            samples.append(_checked(float(line), where))
        except ValueError:
            raise InputError(f"{where}: {EXPECTED}") from None
    return samples


def _checked(milliseconds: float, where: str) -> float:
    if not math.isfinite(milliseconds) or not 0.0 <= milliseconds <= LONGEST * 1e3:
        raise InputError(f"{where}: must be from 0 to {LONGEST * 1e3:g} ms")
    return milliseconds * 1e-3
