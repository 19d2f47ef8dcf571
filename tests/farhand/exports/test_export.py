"""Bad input: one line, or what is readable with a note; a folder is whole or not there."""

import numpy as np
import pytest

from farhand.cli import run as farhand
from farhand.common.errors import InputError, RunFileError
from farhand.exports import output
from farhand.exports.export import run_export
from farhand.exports.source import Source, run_at
from farhand.exports.to_tables import write_tables
from farhand.foxglove.recorded_topics import RecordedTopics
from tests.farhand.made_run import TICKS, make_run


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("made") / "made.mcap"
    make_run(path, ticks=30)
    return path, path.read_bytes()


def told(path, folder):
    """Ticks that are exported and notes, or the line that refuses."""
    folder.mkdir()
    try:
        source = write_tables([run_at(path)], "csv", folder)[0]
    except RunFileError as error:
        return 0, [str(error)]
    rows = (folder / "ticks.csv").read_text().count("\n") - 1
    assert rows == source.ticks
    return rows, source.notes


def test_a_file_cut_off_anywhere_gives_what_is_before_the_cut_and_says_so(whole, tmp_path):
    _, data = whole
    lengths = [
        0,
        1,
        7,
        8,
        9,
        *map(int, np.random.default_rng(1).integers(10, len(data) - 1, 60)),
        len(data) - 1,
    ]
    ticks = []
    for number, length in enumerate(sorted(lengths)):
        path = tmp_path / f"{number}.mcap"
        path.write_bytes(data[:length])
        rows, notes = told(path, tmp_path / f"{number}")
        assert notes
        assert not any("\n" in note for note in notes)
        ticks.append(rows)
    assert ticks == sorted(ticks)
    assert ticks[-1] == 30


def test_a_flipped_bit_never_passes_for_a_whole_run_of_fewer_ticks(whole, tmp_path):
    _, data = whole
    rng = np.random.default_rng(2)
    for number in range(60):
        at, bit = int(rng.integers(len(data))), int(rng.integers(8))
        broken = bytearray(data)
        broken[at] ^= 1 << bit
        path = tmp_path / f"{number}.mcap"
        path.write_bytes(broken)
        rows, notes = told(path, tmp_path / f"{number}")
        assert rows == 30 or any("tick" in each or "ends early" in each or "run" in each for each in notes), (
            at,
            bit,
        )


def test_ticks_that_are_lost_at_the_end_are_counted(whole, tmp_path):
    path, data = whole
    topics = RecordedTopics(path)
    last, first = topics.chunks[-1], topics.chunks[1]
    broken = bytearray(data)
    for chunk in (last, first):
        broken[chunk.start + chunk.size - 5] ^= 1
    topics.close()
    (tmp_path / "x.mcap").write_bytes(broken)
    rows, notes = told(tmp_path / "x.mcap", tmp_path / "x")
    missing = [int(each.split()[0]) for each in notes if "ticks" in each]
    assert len(missing) == 2
    assert rows + sum(missing) == 30


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "it is empty"),
        (b"hello, this is not a recording at all", "not a recording of Farhand"),
        (b"\x89MCAP0\r\n", "not a recording of Farhand"),
    ],
)
def test_what_is_not_ours_is_one_line(content, words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.mcap").write_bytes(content)
    for form in ("csv", "parquet", "lerobot", "rosbag2"):
        assert farhand(["export", "x.mcap", "--to", form, "--out", "out"]) == 2
        said = capsys.readouterr().err
        assert words in said
        assert said.count("\n") == 1
        assert [each.name for each in tmp_path.iterdir()] == ["x.mcap"]


def test_bad_words_are_one_line(whole, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = str(whole[0])
    (tmp_path / "file").write_text("x")
    for words, said in (
        ([path, "--to", "hdf5", "--out", "o"], "expected one of lerobot, rosbag2, csv, parquet"),
        (["nope", "--to", "csv", "--out", "o"], "no such file"),
        ([path, "--to", "csv", "--out", "file"], "is a file"),
        ([path, "--to", "csv", "--out", "file/o"], "cannot be written"),
    ):
        assert farhand(["export", *words]) == 2
        err = capsys.readouterr().err
        assert said in err
        assert err.count("\n") == 1


def test_a_missing_package_is_named(whole, tmp_path, monkeypatch):
    found = output.importlib.util.find_spec
    monkeypatch.setattr(
        output.importlib.util, "find_spec", lambda name, *rest: None if name == "av" else found(name, *rest)
    )
    with pytest.raises(
        InputError, match=r"av not installed; expected what `pip install 'farhand\[export\]'` brings"
    ):
        run_export([whole[0]], "lerobot", tmp_path / "o")
    assert run_export([whole[0]], "csv", tmp_path / "o") == 0


def test_an_export_is_replaced_only_when_told_and_nothing_else_ever(whole, tmp_path):
    out = tmp_path / "out"
    run_export([whole[0]], "csv", out)
    with pytest.raises(InputError, match=r"holds an export already; .*--force"):
        run_export([whole[0]], "csv", out)
    assert run_export([whole[0]], "parquet", out, force=True) == 0
    assert not (out / "ticks.csv").exists()
    assert (out / "ticks.parquet").exists()
    other = tmp_path / "photos"
    other.mkdir()
    (other / "me.jpg").write_text("x")
    with pytest.raises(InputError, match="holds other things"):
        run_export([whole[0]], "csv", other, force=True)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["out", "photos"]


def test_a_failure_on_the_way_leaves_what_was_there(whole, tmp_path, monkeypatch):
    out = tmp_path / "out"
    run_export([whole[0]], "csv", out)
    before = (out / "ticks.csv").read_bytes()
    full = OSError(28, "No space left on device")

    def fail(*_):
        raise full

    monkeypatch.setattr("farhand.exports.to_tables.run_row", fail)
    with pytest.raises(OSError, match="No space") as found:
        run_export([whole[0]], "csv", out, force=True)
    assert found.value.filename == str(out)
    assert (out / "ticks.csv").read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["out"]


def test_a_recording_that_began_later_and_lacks_ticks_says_so(tmp_path):
    make_run(tmp_path / "late.mcap", left_out=range(5), first_tick=5)
    source = Source(run_at(tmp_path / "late.mcap"))
    assert sum(1 for _ in source.items()) == TICKS - 5
    assert source.notes == ["recording began with tick 5 of the run"]
