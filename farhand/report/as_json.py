"""The figures of one run or two as one line of JSON, the same bytes for the same run."""

import math
from collections.abc import Sequence
from typing import Any

import msgspec

from farhand.report.reading.evidence import Evidence
from farhand.report.reading.figures import SCHEMA, figures_of
from farhand.report.reading.settings import differing

DIGITS = 6


def to_json(runs: Sequence[Evidence]) -> str:
    """One line; see docs/recordings.md for what is in it."""
    found: dict[str, Any] = {"schema": SCHEMA, "runs": [_run(each) for each in runs]}
    if len(runs) == 2:
        first, second = (each.story.info.scenario for each in runs)
        found["differing"] = differing(first, second)
    return msgspec.json.encode(_rounded(msgspec.to_builtins(found))).decode()


def _run(run: Evidence) -> dict[str, Any]:
    """Without its name, which is that of a folder and no figure."""
    found: dict[str, Any] = msgspec.to_builtins(figures_of(run))
    del found["name"]
    return found


def _rounded(node: Any) -> Any:
    if isinstance(node, float):
        return float(f"{node:.{DIGITS}g}") if math.isfinite(node) else None
    if isinstance(node, dict):
        return {key: _rounded(value) for key, value in node.items()}
    if isinstance(node, (list, tuple)):
        return [_rounded(each) for each in node]
    return node
