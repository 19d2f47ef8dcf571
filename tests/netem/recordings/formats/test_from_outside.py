"""Formats that installed packages bring, and in which order formats are asked."""

import json
import math
from typing import ClassVar

import pytest
from typer.testing import CliRunner

from farhand.cli import app
from farhand.common.errors import TraceError
from farhand.netem.chain import Chain
from farhand.netem.recordings.formats.base import TraceFormat, TraceOptions, TraceSamples, TraceText
from farhand.netem.recordings.formats.registry import FORMATS, format_of
from farhand.netem.recordings.trace import load_trace
from farhand.netem.spec import parse_spec

GROUP = "farhand.trace_formats"


class Semicolons(TraceFormat):
    """Number; delay in ms. The header holds a comma, so csv would take it too."""

    name: ClassVar[str] = "semicolons"

    def matches(self, text: TraceText) -> bool:
        return text.lines[0] == "number;delay, ms"

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        samples = TraceSamples(options.kind or "one-way", provenance="theirs", period=0.02)
        for line, content in enumerate(text.lines[1:], start=2):
            if content:
                word = content.partition(";")[2]
                if not word.replace(".", "").isdigit():
                    text.fail(f"expected a delay, got {text.excerpt(line)}", line)
                samples.delays.append(float(word) * 1e-3)
        return samples


class Anything(Semicolons):
    """Takes every text, but is asked last."""

    name: ClassVar[str] = "anything"
    general: ClassVar[bool] = True

    def matches(self, text: TraceText) -> bool:
        return True


class Nonsense(Semicolons):
    """Gives what is no trace."""

    def read(self, text: TraceText, options: TraceOptions) -> TraceSamples:
        if text.lines[1] == "times":
            return TraceSamples("one-way", delays=[0.1, 0.2], times=[0.0])
        return TraceSamples("one-way", delays=[-0.1 if text.lines[1] == "negative" else math.inf])


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "theirs.txt"
    path.write_text("number;delay, ms\n1;20\n2;30\n")
    return path


def test_it_is_asked_before_the_general_ones_and_after_the_particular_ones(brought, file):
    brought(GROUP, "semicolons", f"{__name__}:Semicolons")
    assert FORMATS.names() == ("cicv5g", "irtt", "fping", "hping3", "ping", "csv", "slots", "semicolons")
    assert load_trace(file).recorded.tolist() == [0.02, 0.03]
    assert load_trace(file, format="semicolons").provenance == "theirs"
    with pytest.raises(TraceError, match="which column is the delay"):
        load_trace(file, format="csv")


def test_a_general_one_comes_last_of_all(brought, file):
    brought(GROUP, "anything", f"{__name__}:Anything")
    assert format_of(TraceText("x", ["# farhand trace"])).name == "csv"
    assert format_of(TraceText("x", ["PING a"])).name == "ping"
    assert format_of(TraceText("x", ["12"])).name == "slots"
    assert format_of(TraceText("x", ["what is this"])).name == "anything"


def test_show_and_a_spec_take_it(brought, file):
    brought(GROUP, "semicolons", f"{__name__}:Semicolons")
    shown = CliRunner().invoke(app, ["trace", "show", str(file), "--json"])
    assert json.loads(shown.output)["provenance"] == "theirs"
    spec = parse_spec(f"trace:{file},format=semicolons")
    assert str(spec) == f"trace:{file},format=semicolons"
    Chain(spec, 1, "uplink")


def test_errors_are_one_line_with_the_file(brought, file):
    brought(GROUP, "semicolons", f"{__name__}:Semicolons")
    file.write_text("number;delay, ms\n1;twenty\n")
    with pytest.raises(TraceError, match=r"theirs.txt, line 2: expected a delay, got '1;twenty'"):
        load_trace(file)
    with pytest.raises(
        TraceError, match=r"theirs.txt: format 'semicolon': no such trace format; is 'semicolons' me"
    ):
        load_trace(file, format="semicolon")


def test_a_broken_package_is_named(brought, file):
    brought(GROUP, "broken", "no_such_module:Broken")
    with pytest.raises(TraceError, match=r"theirs.txt: package their-package: .* cannot be imported"):
        load_trace(file)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("negative", "negative or infinite"),
        ("inf", "negative or infinite"),
        ("times", "1 times for 2 delays"),
    ],
)
def test_what_a_format_gives_is_checked(brought, file, line, words):
    brought(GROUP, "semicolons", f"{__name__}:Nonsense")
    file.write_text(f"number;delay, ms\n{line}\n")
    with pytest.raises(TraceError, match=words):
        load_trace(file)
