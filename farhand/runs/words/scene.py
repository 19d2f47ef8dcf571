"""What of a robot's scene was changed while it ran, in words."""

from farhand.common.messages.scene import Obstacle, Scene


def scene_words(before: Scene | None, after: Scene) -> str:
    """One line where the obstacles were changed between two scenes of one start of a robot; else an empty string."""
    if before is None or before.session != after.session or before.changes == after.changes:
        return ""
    had, has = _fixed(before.obstacles), _fixed(after.obstacles)
    found = [
        *(f"{name} came" for name in has if name not in had),
        *(f"{name} went" for name in had if name not in has),
        *(f"{name} is another one" for name in has if name in had and has[name] != had[name]),
    ]
    told = ", ".join(found[:8]) + (f" and {len(found) - 8} more" if len(found) > 8 else "")
    return f"the scene was changed (revision {after.changes}): {told or 'as it was'}"


def _fixed(obstacles: tuple[Obstacle, ...]) -> dict[str, object]:
    """What of each obstacle does not change with time."""
    return {
        o.id: (o.shape, o.orientation, o.path, o.speed, None if o.moves else o.position) for o in obstacles
    }
