"""Where the recordings are that tests read: those made for them, which are always there, and measured ones."""

from pathlib import Path

import pytest

SAMPLES = sorted(Path(__file__).parent.glob("*.txt"))
"""Made by make.py."""
MEASURED = Path(__file__).resolve().parents[5] / "shared" / "traces"
"""Measured by others and no part of the repository: looked at as well where they lie beside it."""


def measured(name: str) -> Path:
    """A measured recording; skips the test where there is none."""
    path = MEASURED / name
    if not path.exists():
        pytest.skip(
            f"measured recordings are no part of the repository, and ../shared/traces/{name} is not there"
        )
    return path
