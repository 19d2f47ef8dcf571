"""What was asked in a recorded run, asked again: the same input over another network, or of another controller."""

from pathlib import Path
from typing import Any, ClassVar

from farhand.common.errors import InputError
from farhand.common.scenario.section import Section
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.recorded.course import read_course
from farhand.operator_side.steering.recorded.playback import Playback

SETTLES_NS = 3_000_000_000
"""So long after its end the run goes on: a robot far away is still on its way."""
_LATCHED = ("stopped", "estop")


class RecordedSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    run: file of the recording.
    """

    run: str = ""


class Recorded(SteeringDevice):
    """Asks at the offsets of then, from the first tick on in which it may drive; raises InputError for a bad file.

    It acknowledges nothing: a stop was not seen by whoever asked. A stop ends the press that is held then.
    """

    Settings: ClassVar[type[Section]] = RecordedSettings

    def __init__(self, settings: Any = None) -> None:
        super().__init__(settings or RecordedSettings())
        if not self.settings.run:
            raise InputError("steering.recorded.run: names no recording; say --steer recorded:RUN")
        self._playback = Playback(read_course(Path(self.settings.run)))

    def read(self, view: View) -> SteeringInput:
        """See SteeringDevice."""
        playback, now_ns = self._playback, view.now_ns
        stopped = view.state.mode in _LATCHED
        if playback.started_ns is None and view.driving and not stopped:
            playback.start(now_ns)
        asked = playback.asked(now_ns, let_go=stopped)
        self.over = playback.left_ns(now_ns) < -SETTLES_NS
        return SteeringInput(
            velocity=asked.linear,
            angular=asked.angular,
            engaged=asked.press > 0,
            estop=asked.estop,
            says="what is played acknowledges nothing; a person must" if stopped else "",
        )
