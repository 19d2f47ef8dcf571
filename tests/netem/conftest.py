"""Packages that bring kinds of their own, as entry points that are not installed."""

import importlib.metadata

import pytest

from farhand.netem.impairments.registry import IMPAIRMENTS
from farhand.netem.recordings.formats.registry import FORMATS


class _Distribution:
    name = "their-package"


@pytest.fixture
def brought(monkeypatch):
    """A function that has a package bring `name = value` in a group of entry points."""
    points: list[importlib.metadata.EntryPoint] = []

    def bring(group: str, name: str, value: str) -> None:
        point = importlib.metadata.EntryPoint(name, value, group)
        vars(point).update(dist=_Distribution())
        points.append(point)

    installed = importlib.metadata.entry_points

    def entry_points(**wanted: str) -> list[importlib.metadata.EntryPoint]:
        return [p for p in points if p.group == wanted.get("group")] or installed(**wanted)

    monkeypatch.setattr("importlib.metadata.entry_points", entry_points)
    for registry in (IMPAIRMENTS, FORMATS):
        monkeypatch.setattr(registry, "_outside", None)
        monkeypatch.setattr(registry, "_loaded", {})
    return bring
