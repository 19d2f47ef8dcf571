"""A damaged recording: what is readable, with a note of what is missing; never a wrong figure without a word."""

import os

import msgspec
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from farhand.cli import run as run_cli
from farhand.common.errors import InputError
from farhand.common.recording.run_file import RunFile
from farhand.laboratory.simulation import simulate
from farhand.report.as_json import to_json
from farhand.report.page import Page
from farhand.report.reading.evidence import Evidence
from farhand.report.reading.story import read_story
from tests.farhand.report.test_story import INFO


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    path = tmp_path_factory.mktemp("short") / "run.mcap"
    simulate("point-obstacle", network="5g-urban", record_to=path, time_limit=1.0)
    return path.read_bytes()


def told(source):
    story = read_story(source)
    run = Evidence("x", story, lacks=story.lacks)
    return to_json([run]), run


def told_or_refused(source):
    """Figures, the run and no refusal; or nothing and the one line of the refusal."""
    try:
        return *told(source), ""
    except InputError as error:
        return None, None, str(error)


def test_cut_off_at_any_length_the_page_says_that_something_is_missing(data, in_memory):
    readable = 0
    for length in [*range(0, len(data), 499), *range(len(data) - 40, len(data))]:
        _, run, refused = told_or_refused(in_memory(data[:length]))
        if refused:
            assert "\n" not in refused
            assert readable == 0, length
            continue
        readable += 1
        assert run.lacks, length
        if length % 5 == 0:
            assert "What is missing" in Page([run]).html()
    assert readable > 50


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**9), st.integers(0, 7))
@example(-1, 0)
def test_a_flipped_bit_changes_no_figure_without_a_word(data, in_memory, place, bit):
    place = data.index(b"/network/downlink") - 6 if place < 0 else place % len(data)
    flipped = bytearray(data)
    flipped[place] ^= 1 << bit
    found, run, refused = told_or_refused(in_memory(bytes(flipped)))
    assert "\n" not in refused
    assert refused or run.lacks or found == told(in_memory(data))[0]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "it is empty"),
        (b"nonsense", "not a recording of Farhand"),
        (b"\x89MCAP0\r\n", "holds no description"),
    ],
)
def test_what_is_no_recording_is_one_line(content, said, in_memory):
    with pytest.raises(InputError, match=said) as found:
        read_story(in_memory(content))
    assert "\n" not in str(found.value)


def test_a_recording_of_another_format_is_one_line(tmp_path):
    path = tmp_path / "old.mcap"
    RunFile(path, msgspec.structs.replace(INFO, format="farhand-run-2")).close()
    with pytest.raises(InputError, match="'farhand-run-2'; this program reads"):
        read_story(path)


def test_what_is_neither_file_nor_folder_is_not_waited_for(tmp_path, capsys):
    path = tmp_path / "pipe.mcap"
    os.mkfifo(path)
    assert run_cli(["report", str(path)]) == 2
    assert capsys.readouterr().err.endswith(
        "is neither file nor folder; expected a run's folder or its run.mcap\n"
    )


def test_a_recording_without_a_tick_has_a_page(tmp_path):
    path = tmp_path / "none.mcap"
    RunFile(path, INFO).close()
    found, run = told(path)
    assert run.lacks == ["the recording holds no tick"]
    assert "the recording holds no tick" in Page([run]).html()
    assert '"clearance":null' in found
