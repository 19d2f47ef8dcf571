"""Quantities as people read them."""


def milliseconds(value: float | None) -> str:
    """Seconds as ms for people; a dash for None."""
    return "–" if value is None else f"{value * 1e3:.1f}"
