"""What the docs say of the emulator: the examples work, and no word or format is left out."""

import importlib
import re
import sys
from pathlib import Path

import pytest

from farhand.common.errors import TraceError
from farhand.common.link.link import Packet
from farhand.netem.chain import Chain
from farhand.netem.impairments.registry import BUILT_IN
from farhand.netem.models.profiles import PROFILES
from farhand.netem.recordings.formats.registry import FORMATS
from farhand.netem.recordings.trace import load_trace
from farhand.netem.spec import parse_spec

DOCS = Path(__file__).resolve().parents[2] / "docs"
MS = 1_000_000


@pytest.fixture
def example(brought, tmp_path, monkeypatch):
    """A function that makes an example of docs/extend.md a module, and brings what its entry point names."""
    page = (DOCS / "extend.md").read_text(encoding="utf-8")

    def install(group: str) -> None:
        section = page[page.index(f'[project.entry-points."{group}"]') :]
        name, module, kind = re.search(r'\n(\S+) = "(\w+):(\w+)"', section).groups()
        code = re.search(r"```python\n(.*?)```", section, re.DOTALL).group(1)
        (tmp_path / f"{module}.py").write_text(code)
        importlib.invalidate_caches()
        modules.append(module)
        brought(group, name, f"{module}:{kind}")

    modules: list[str] = []
    monkeypatch.syspath_prepend(tmp_path)
    yield install
    for module in modules:
        sys.modules.pop(module, None)


def test_the_example_of_an_impairment(example):
    example("farhand.impairments")
    spec = parse_spec("late:3,20.5 constant:5")
    assert str(spec) == "constant:5 late:3,20.5"
    chain = Chain(spec, 1, "uplink")
    found = [chain.offer(Packet("a", b"", at * MS), at * MS)[0].release_ns / MS - at for at in (1, 2, 3)]
    assert found == [5, 5, 25.5]


def test_the_example_of_a_format(example, tmp_path):
    example("farhand.trace_formats")
    path = tmp_path / "log.txt"
    path.write_text("time;delay\n0.0;0.02\n0.1;\n0.2;0.03\n")
    trace = load_trace(path)
    assert trace.times.tolist() == [0.0, 0.1, 0.2]
    assert trace.recorded.tolist()[::2] == [0.02, 0.03]
    path.write_text("time;delay\n0.0;soon\n")
    with pytest.raises(TraceError, match=r"line 2: expected time;delay, got '0.0;soon'"):
        load_trace(path)


def test_every_word_and_every_format_is_in_the_tables():
    netem, traces = ((DOCS / page).read_text(encoding="utf-8") for page in ("netem.md", "traces.md"))
    for name in set(BUILT_IN) - set(PROFILES):
        assert re.search(rf"`{name}\b", netem), name
    for name in (*FORMATS.names(), *PROFILES):
        assert f"`{name}`" in traces or f"`{name}`" in netem or name.startswith("bursty-loss-"), name


@pytest.mark.parametrize("page", ["netem.md", "traces.md"])
def test_paths_on_the_pages_exist(page):
    for path in re.findall(r"`(netem/[\w/.-]*)`", (DOCS / page).read_text(encoding="utf-8")):
        assert (DOCS.parent / path).exists(), path
