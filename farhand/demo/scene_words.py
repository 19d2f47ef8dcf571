"""What is around the robot, in a few words: how many obstacles, and when they changed last."""

from farhand.common.messages.scene import Scene

MINUTE = 60.0


class SceneWords:
    """Follows the scenes that a robot announces, on the clock of whoever listens."""

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self._changed_ns: int | None = None

    def take(self, scene: Scene, at_ns: int) -> None:
        """One that arrived at `at_ns`; an older one than the newest of its session says nothing new."""
        known = self._scene
        if scene.overtaken_by(known):
            return
        if known is not None and (known.session, known.changes) != (scene.session, scene.changes):
            self._changed_ns = at_ns  # also of a robot that starts anew: it has its scenario's again
        self._scene = scene

    def words(self, now_ns: int) -> str:
        """Such as `3 obstacles, changed 12 s ago`; empty before the first scene."""
        scene = self._scene
        if scene is None:
            return ""
        count = len(scene.obstacles)
        there = f"{count} obstacle{'s' * (count != 1)}"
        if self._changed_ns is None:
            return f"{there}, changed before this began" if scene.changes else f"{there}, as in its scenario"
        ago = (now_ns - self._changed_ns) * 1e-9
        return f"{there}, changed {f'{ago:.0f} s' if ago < MINUTE else f'{ago / MINUTE:.0f} min'} ago"
