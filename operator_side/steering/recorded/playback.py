"""Plays a course by the rules of hold-to-run: what let go of a press goes on with the next one that was made then."""

from farhand.operator_side.steering.recorded.course import Asked, Course


class Playback:
    """Args:
    course: what is played.

    Attributes:
        started_ns: when it was started; None before.
    """

    def __init__(self, course: Course) -> None:
        self.course = course
        self.started_ns: int | None = None
        self._spent = 0  # the last press that was let go of

    def start(self, now_ns: int) -> None:
        """Begin with what was asked at the start of the drive."""
        self.started_ns = now_ns

    def asked(self, now_ns: int, *, let_go: bool = False) -> Asked:
        """What is asked at `now_ns`.

        Args:
            now_ns: never goes back.
            let_go: something ends the press that is held, such as a stop of the robot.
        """
        if self.started_ns is None:
            return Asked()
        asked = self.course.at(now_ns - self.started_ns)
        if let_go:
            self._spent = max(self._spent, asked.press)
        return asked if asked.press > self._spent or asked.estop else Asked()

    def left_ns(self, now_ns: int) -> int:
        """Until its end; negative afterwards."""
        since_ns = 0 if self.started_ns is None else now_ns - self.started_ns
        return self.course.duration_ns - since_ns
