"""Whom console, camera and recorder make late: the robot's loop, and the controller's ticks."""

import statistics
from typing import Any

from benchmarks.seat.system import system_of
from benchmarks.seat.threads import load


def late(times: int, seconds: float) -> dict[str, Any]:
    """p99 of how late robot loop and controller ticks are, without and with console, camera and recorder."""
    found: dict[str, list[dict[str, float]]] = {"without": [], "with": []}
    for _ in range(times):
        for name, seated in (("without", False), ("with", True)):
            with system_of(console=seated, camera=seated, served=seated) as system:
                if seated:
                    for _ in range(round(seconds / 1.0)):
                        system.press()
                        system.rest(0.6)
                        system.let_go()
                        system.rest(0.4)
                else:
                    system.rest(seconds)
                busy, pictures = load(), system.pictures
                result = system.end()
            found[name].append(
                {
                    "robot": result["robot"]["lateness"]["p99"],
                    "controller": result["operator"]["lateness_p99"],
                    "load": busy,
                    "pictures": pictures,
                }
            )
    medians = {
        name: {
            what: statistics.median(each[what] for each in rows) for what in ("robot", "controller", "load")
        }
        for name, rows in found.items()
    }
    ratios = {what: medians["with"][what] / medians["without"][what] for what in ("robot", "controller")}
    return {"runs": found, "medians": medians, "ratios": ratios}
