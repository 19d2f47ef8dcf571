"""What the guard on the robot did, in words."""

from farhand.common.messages.intervention import Intervention
from farhand.robot_side.result import GuardedPair, RobotCounts

SHOWN_PAIRS = 4


def guard_words(did: Intervention) -> str:
    """`slowed: forearm 31 mm from post-2, limit 10 mm; 0.30 m/s asked, 0.12 m/s done`."""
    where = f"{did.part} {_mm(did.distance)}"
    where += f" from {did.obstacle}" if did.obstacle else " from the nearest"
    digits = 2 if f"{did.asked:.2f}" != f"{did.done:.2f}" else 3
    asked, done = f"{did.asked:.{digits}f} m/s asked", f"{did.done:.{digits}f} m/s done"
    return f"{did.what}: {where}, limit {_mm(did.limit)}; {asked}, {done}"


def guard_summary(counts: RobotCounts, pairs: list[GuardedPair]) -> str:
    """What it did in a run: how often, for how long, how, and for the sake of what; empty where nothing is known.

    Args:
        counts: of the robot.
        pairs: parts and obstacles, longest first. Their distances are of the guard's own capsules, exact and while it
            acted; a simulated arm's clearance is measured on its meshes, and falls short (see ArmWorld.clearance).
    """
    if not counts.ticks:
        return ""
    if not counts.guarded:
        return "off"
    if not counts.guard_times:
        return "on; had nothing to do"
    deeds = sorted(counts.guard_deeds.items(), key=lambda item: -item[1])
    how = ", ".join(f"{what} {seconds:.1f} s" for what, seconds in deeds)
    times = "once" if counts.guard_times == 1 else f"{counts.guard_times} times"
    whom = [
        f"{p.part} and {p.obstacle or 'the nearest'!r} {p.seconds:.1f} s, {_mm(p.distance)} least"
        for p in pairs
    ]
    if len(whom) > SHOWN_PAIRS:
        whom[SHOWN_PAIRS:] = [f"and {len(whom) - SHOWN_PAIRS} more"]
    told = f"acted {times}, for {counts.guard_seconds:.1f} s ({how})"
    return f"{told}: {'; '.join(whom)}, as the guard measures" if whom else told


def _mm(metres: float) -> str:
    return f"{metres * 1e3:.0f} mm"
