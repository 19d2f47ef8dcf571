"""What was asked for in a recorded run, by whatever steered, at its original offsets from the start of the drive."""

from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from farhand.common.errors import RunFileError
from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.codec import Decoder
from farhand.common.messages.report import ControlReport
from farhand.common.recording.reader import read_run

EARLY = 0.25
"""Share of a period by which an instant may come early: two loops of one period are never exactly in step."""


@dataclass(frozen=True, slots=True)
class Asked:
    """Attributes:
    press: counts the presses so far; 0: nothing is held down.
    linear, angular: of the tool, in base (m/s, rad/s).
    estop: an emergency stop was asked for.
    """

    press: int = 0
    linear: Vector3 = ZERO
    angular: Vector3 = ZERO
    estop: bool = False


class Course:
    """Args:
    samples: instants (ns) and what was asked from each on; at least one. The first is the start of the drive.
    """

    def __init__(self, samples: list[tuple[int, Asked]]) -> None:
        start_ns = samples[0][0]
        self._offsets = [instant_ns - start_ns for instant_ns, _ in samples]
        self._asked = [asked for _, asked in samples]
        steps = [b - a for a, b in zip(self._offsets, self._offsets[1:], strict=False)]
        self._period_ns = round(median(steps)) if steps else 0
        self.duration_ns = self._offsets[-1] + self._period_ns

    def at(self, offset_ns: int) -> Asked:
        """What was asked at an offset from the start; after the end, nothing."""
        offset_ns += round(EARLY * self._period_ns)
        if not 0 <= offset_ns < self.duration_ns + round(EARLY * self._period_ns):
            return Asked()
        return self._asked[bisect_right(self._offsets, offset_ns) - 1]


def read_course(path: Path) -> Course:
    """The course of a recorded run; raises RunFileError where it is not whole, or nothing was asked in it."""
    run = read_run(path)
    if not run.complete:
        lacks = "it is cut off" if run.cut_off else run.flaws()[0]
        raise RunFileError(f"run {path}: cannot be played, {lacks}; play one that is whole")
    decoder = Decoder(ControlReport)
    samples: list[tuple[int, Asked]] = []
    press, held = 0, False
    for number, tick in enumerate(run.ticks):
        report = decoder.decode(tick.report)
        if report is None:
            raise RunFileError(f"run {path}: tick {number}: unreadable report: {decoder.last_refusal}")
        if not samples and report.mode != "run":
            continue
        holds = report.mode == "run" or any(report.desired) or any(report.desired_angular)
        press += holds and not held
        held = holds
        asked = Asked(press, report.desired, report.desired_angular) if holds else Asked()
        samples.append((tick.now_ns, Asked(estop=True) if report.mode == "estop" else asked))
    if not samples:
        raise RunFileError(f"run {path}: cannot be played: nothing was driven in it")
    return Course(samples)
