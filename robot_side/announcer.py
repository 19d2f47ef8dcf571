"""What the robot's program says to people: who has control, stops, and what it refuses."""

from collections.abc import Callable

from farhand.common.messages.state import FAULT
from farhand.common.timing.clock import to_ns
from farhand.common.trust.rare_lines import RareLines
from farhand.robot_side.safety.command_intake import CommandIntake
from farhand.robot_side.safety.scene_intake import SceneIntake
from farhand.robot_side.safety.watchdog import ModeChange, Watchdog

LOOK_EVERY = 0.25
MOST_TOLD = 64
"""Reasons of one stop."""
SCENE_AGAIN = 1.0
"""s between two lines on refused changes of the scene."""
_MEANINGS = {
    "foreign-session": "of a session that does not hold control",
    "held": "asks for control that another one holds",
    "late-release": "gives up control that it does not hold",
    "no-successor": "hands control over to one that does not wait for it",
    "old-seq": "not newer than the last: replayed or overtaken",
    "stale": "built on a state that is too old",
    "no-echo": "built on no state of this robot",
    "foreign-echo": "built on a state of another start of this robot",
    "stopped": "the robot is stopped and was not acknowledged",
    "unseen-stop": "acknowledges a stop that it had not seen",
    "too-fast": "faster than safety.max_speed",
    "turns-too-fast": "turns faster than safety.max_angular_speed",
    "flood": "more at once than are looked at",
}


class Announcer:
    """Looks at a robot's watchdog and intake from time to time; touches neither.

    Args:
        say: takes a line for people.
        watchdog, intake, scene: of the robot's node.
    """

    def __init__(
        self,
        say: Callable[[str], None],
        watchdog: Watchdog,
        intake: CommandIntake,
        scene: SceneIntake | None = None,
    ) -> None:
        self._say, self._watchdog, self._intake, self._scene = say, watchdog, intake, scene
        self._lines, self._scene_lines = RareLines(say), RareLines(say, SCENE_AGAIN)
        self._next_ns = 0
        self._holder = 0
        self._stops = 0
        self._latched = False
        self._told: set[str] = set()  # reasons of the stop that is latched
        self._seen: ModeChange | None = None
        self._refused: dict[str, int] = {}
        self._scene_refused = 0

    def look(self, now_ns: int) -> None:
        """Say what is new since the last look, if it is time for one."""
        if now_ns < self._next_ns:
            return
        self._next_ns = now_ns + to_ns(LOOK_EVERY)
        watchdog = self._watchdog
        lease = watchdog.lease
        if lease.holder != self._holder:
            self._holder = lease.holder
            holder = f"{lease.holder_name}, session {lease.holder:x}," if lease.holder else "nobody"
            self._say(f"{holder} has control{self._why_free()}")
        if watchdog.stops != self._stops:
            self._stops, self._latched = watchdog.stops, True
            self._told.clear()
        for change in self._new_changes():
            if change.mode in ("stopped", "estop") and change.reason not in self._told:
                self._tell_stop(change.reason, now_ns)
        if self._latched and not watchdog.latched:
            self._latched = False
            who = f" by {lease.holder_name}" if lease.holder_name else ""
            self._say(f"acknowledged{who}: may move again")
        refused = self._intake.refused()
        for reason, count in refused.items():
            new = count - self._refused.get(reason, 0)
            if new:
                self._lines.note(reason, self._refusal(reason), now_ns, new)
        self._refused = refused
        if self._scene is not None:
            self._look_at_scene(self._scene, now_ns)
        self._lines.tick(now_ns)

    def _new_changes(self) -> list[ModeChange]:
        """Of the watchdog since the last look, the oldest first."""
        found: list[ModeChange] = []
        for change in reversed(self._watchdog.changes):
            if change is self._seen:
                break
            found.append(change)
        if found:
            self._seen = found[0]
        return found[::-1]

    def _tell_stop(self, reason: str, now_ns: int) -> None:
        """A stop, or one that goes on for another reason as well: each is said once, a flood is counted."""
        if len(self._told) < MOST_TOLD:
            self._told.add(reason)
            self._say(f"stop: {reason}")
        else:
            self._lines.note("fault" if FAULT in reason else "stop", f"stop: {reason}", now_ns, 1)

    def _look_at_scene(self, scene: SceneIntake, now_ns: int) -> None:
        while scene.log:
            self._say(scene.log.popleft())
        refused = sum(scene.refused.values())
        if refused > self._scene_refused:
            text = f"scene: refused {scene.newest_refusal}"
            self._scene_lines.note("", text, now_ns, refused - self._scene_refused)
            self._scene_refused = refused
        self._scene_lines.tick(now_ns)

    def _why_free(self) -> str:
        lease = self._watchdog.lease
        why = {"released": "it was released", "silent": "its holder fell silent"}.get(lease.end, "")
        return f": {why}" if why and not lease.holder else ""

    def _refusal(self, reason: str) -> str:
        newest = self._watchdog.newest_refused.get(reason)
        meaning = _MEANINGS.get(reason, reason)
        if newest is None:  # nobody knows whose: it was not read
            return f"refused a command: {meaning}"
        return f"refused a command of {newest[0]!r}, session {newest[1]:x}: {meaning}"
