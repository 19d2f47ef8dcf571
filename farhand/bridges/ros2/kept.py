"""The distance that a controller keeps from obstacles, as a run's scenario says it."""

from farhand.common.recording.records import RunInfo


def kept_in(info: RunInfo) -> float | None:
    """Without the margin (m); None: it is not said."""
    controller = info.scenario.get("controller")
    found = controller.get("d_min") if isinstance(controller, dict) else None
    return float(found) if isinstance(found, int | float) else None
