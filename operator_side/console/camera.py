"""A camera's pictures on their way to the pages: the newest alone, one at a time, with how old they are."""

from typing import Any

from farhand.common.link.link import Packet
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import mirror_key
from farhand.operator_side.console.picture import Picture
from farhand.operator_side.console.stamps import Stamps

MOST_HZ = 20.0
"""Pictures a second and page."""
SILENT, OLD = 1.0, 1.0
"""Without a picture for so long, or with one that is surely older, that is said (s)."""
SEVERAL = 2.5
"""So many of a slow camera's own periods are no silence."""
TELL_AGAIN, GIVE_UP = 0.5, 2.0
"""How often it is said again, and after how long a page that has not acknowledged a picture gets another one (s)."""
MOST_UNASKED = 50
"""Acknowledgements of nothing, beyond those that were due: a page that was given up on says some late."""
_BURST = 1.5  # pictures
_SLOWEST = 5.0  # s between two pictures of a slow camera


class _Shown:
    """What one page has."""

    def __init__(self, now_ns: int) -> None:
        self.picture: CameraFrame | None = None
        self.on_its_way = False
        self.sent_ns = self.told_ns = self.filled_ns = now_ns
        self.allowance = 1.0
        self.said = ""
        self.unasked = 0

    def may_have(self, now_ns: int) -> bool:
        """Whether it may have another picture now."""
        self.allowance = min(_BURST, self.allowance + (now_ns - self.filled_ns) * 1e-9 * MOST_HZ)
        self.filled_ns = now_ns
        waits = self.on_its_way and (now_ns - self.sent_ns) * 1e-9 < GIVE_UP
        return self.allowance >= 1.0 and not waits


class CameraFeed:
    """Args:
    robot: the robot's name.
    """

    def __init__(self, robot: str) -> None:
        self._key = mirror_key(robot, "camera")
        self._decoder = Decoder(CameraFrame)
        self._newest, self._stamps = Newest(), Stamps()
        self._picture: CameraFrame | None = None
        self._between = 0.0
        self._state_age = 0.0
        self._pages: dict[int, _Shown] = {}

    def take(self, packet: Packet) -> None:
        """Take one packet; what is no picture is left out."""
        if packet.key != self._key:
            return
        found, before_ns = self._decoder.decode(packet.payload), self._newest.arrived_ns
        if found is None or not self._newest.accept(found, packet.arrived_ns):
            return
        if self._picture is not None:
            self._between = min(_SLOWEST, (packet.arrived_ns - before_ns) * 1e-9)
        self._picture = found

    def look(self, picture: Picture, now_ns: int) -> None:
        """Learn what the robot's stamps mean; a few dozen times a second."""
        self._stamps.look(picture, now_ns)
        self._state_age = picture.ages(now_ns)[1]

    def next(self, number: int, now_ns: int) -> dict[str, Any] | None:
        """What page `number` is to be told now, if anything."""
        shown = self._pages.setdefault(number, _Shown(now_ns))
        said = self._said(now_ns)
        new = self._picture is not None and self._picture is not shown.picture and shown.may_have(now_ns)
        again = bool(said) and (now_ns - shown.told_ns) * 1e-9 >= TELL_AGAIN
        if not (new or bool(said) != bool(shown.said) or again):
            return None
        shown.told_ns, shown.said = now_ns, said
        if new:
            shown.picture, shown.sent_ns, shown.on_its_way = self._picture, now_ns, True
            shown.allowance -= 1.0
        return self._told(shown.picture, said, now_ns, with_jpeg=new)

    def pictured(self, number: int) -> bool:
        """Page `number` has the picture that was sent; False where it says so too often."""
        shown = self._pages.get(number)
        if shown is None or not shown.on_its_way:
            if shown is not None:
                shown.unasked += 1
            return shown is not None and shown.unasked <= MOST_UNASKED
        shown.on_its_way = False
        shown.unasked = max(0, shown.unasked - 1)
        return True

    def leave(self, number: int) -> None:
        """A page is gone."""
        self._pages.pop(number, None)

    def _told(
        self, picture: CameraFrame | None, said: str, now_ns: int, *, with_jpeg: bool
    ) -> dict[str, Any]:
        least, most = self._ages(picture, now_ns)
        return {
            "kind": "camera",
            "jpeg": picture.jpeg if picture is not None and with_jpeg else b"",
            "width": picture.width if picture is not None else 0,
            "height": picture.height if picture is not None else 0,
            "source": picture.camera if picture is not None else "",
            "captured_age_ms": most,
            "captured_age_least_ms": least,
            "said": said,
        }

    def _ages(self, picture: CameraFrame | None, now_ns: int) -> tuple[float | None, float | None]:
        """At least and at most how old a picture is (ms); None: not known."""
        if picture is None:
            return None, None
        ages = self._stamps.ages(picture.robot_session, picture.t_captured_ns, now_ns)
        return (None, None) if ages is None else (round(ages[0] * 1e3, 1), round(ages[1] * 1e3, 1))

    def _said(self, now_ns: int) -> str:
        """What is wrong with the pictures; empty: nothing that is known."""
        if self._picture is None:
            return "no camera: no picture has come"
        silent = (now_ns - self._newest.arrived_ns) * 1e-9
        if silent > max(SILENT, SEVERAL * self._between):
            robot = "the robot's states still come" if self._state_age < SILENT else "nor does any state"
            return f"no picture for {silent:.1f} s: {robot}"
        least, _ = self._ages(self._picture, now_ns)
        if least is not None and least > OLD * 1e3:
            return f"the picture is at least {least * 1e-3:.1f} s old"
        return ""
