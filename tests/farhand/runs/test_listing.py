"""The list of runs tells what is there; pruning takes runs' own files and nothing else."""

import fcntl
import io
import json
import os

import msgspec
import pytest
from mcap.reader import make_reader

from farhand.cli import run
from farhand.common.messages.codec import encode
from farhand.common.recording.reader import read_run
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.common.timing.clock import utc_seconds
from farhand.laboratory.simulation import simulate
from farhand.runs.shelf.listing import list_runs
from farhand.runs.shelf.pruning import Bounds, beyond, remove
from farhand.runs.summary import write_summary
from farhand.testing import report

INFO = RunInfo(
    scenario={"name": "point-obstacle", "network": {"uplink": "a", "downlink": "b"}},
    robot="r",
    session=1,
    seed=0,
    versions={},
    clock="real",
)


def list_times(path):
    """First and last instant, as the end of a file says them."""
    with path.open("rb") as file:
        said = make_reader(file).get_summary().statistics
    return said.message_start_time.to_bytes(8, "little") + said.message_end_time.to_bytes(8, "little")


def record(path, began, ticks=11):
    """A recording of a second that began at a time of day (s)."""
    file = RunFile(path, msgspec.structs.replace(INFO, epoch_ns=int(began * 1e9)))
    for number in range(ticks):
        file.tick(TickRecord(number, number * 100_000_000, (), None, encode(report(number))))
    file.close()


@pytest.fixture(scope="module")
def summary():
    return simulate("point-obstacle", time_limit=0.3).summary


@pytest.fixture
def runs(tmp_path, summary):
    """Three runs an hour apart, a day ago; a recording alone; and what is no run."""
    now = utc_seconds()
    for number in range(3):
        folder = tmp_path / f"run-{number}"
        folder.mkdir()
        record(folder / "run.mcap", now - 86_400 + 3600 * number)
        if number:
            write_summary(summary, folder)
    record(tmp_path / "alone.mcap", now - 1000)
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "report.html").write_text("mine")
    (tmp_path / "file.txt").write_text("mine")
    return tmp_path


def test_it_tells_when_what_how_long_and_how_it_went(runs, summary):
    found = {os.path.basename(each.path): each for each in list_runs(runs)}
    assert list(found) == ["run-0", "run-1", "run-2", "alone.mcap"]
    assert found["run-0"].result == "unknown"
    assert found["run-0"].note == "no summary.json"
    assert (found["run-0"].scenario, found["run-0"].network) == ("point-obstacle", "a / b")
    assert found["run-1"].result == "safe, not finished"
    assert found["run-1"].network == summary.network
    assert [each.length for each in found.values()] == pytest.approx(
        [1.0, summary.duration, summary.duration, 1.0]
    )
    assert utc_seconds() - found["run-0"].when == pytest.approx(86_400, abs=60)
    assert found["run-1"].size == sum(each.stat().st_size for each in (runs / "run-1").iterdir())


@pytest.mark.parametrize(
    ("left", "said"),
    [
        ((), "unknown"),
        (("robot",), "safe"),
        (("operator",), "safety unknown, not finished"),
        (("robot", "operator"), "safe, not finished"),
    ],
)
def test_what_a_program_did_not_leave_is_no_result_and_no_length(left, said, runs, summary):
    counts = msgspec.structs.replace(
        summary.counts, **{each: None for each in ("robot", "operator") if each not in left}
    )
    safe = summary.safe and "robot" in left
    write_summary(msgspec.structs.replace(summary, counts=counts, safe=safe), runs / "run-1")
    found = next(each for each in list_runs(runs) if each.path.endswith("run-1"))
    assert found.result == said
    assert found.length == pytest.approx(summary.duration if "operator" in left else 1.0)


def test_a_summary_of_another_run_is_no_result_of_this_one(runs, summary):
    write_summary(msgspec.structs.replace(summary, scenario="another"), runs / "run-1")
    found = {os.path.basename(each.path): each for each in list_runs(runs)}
    assert (found["run-1"].result, found["run-1"].scenario) == ("unknown", "point-obstacle")
    assert found["run-1"].note == "summary.json is of another run"


def test_a_run_that_is_being_written_began_when_it_began_and_lacks_nothing(runs):
    path = runs / "run-0" / "run.mcap"
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])  # changed just now, and without an end
    found = next(each for each in list_runs(runs) if each.path.endswith("run-0"))
    assert (found.result, found.note, found.length) == ("cut off, or being written", "", None)
    assert utc_seconds() - found.when == pytest.approx(86_400, abs=60)


def test_only_a_recording_that_has_a_writer_is_said_to_be_written(runs):
    def result():
        return next(each.result for each in list_runs(runs) if each.path.endswith("new.mcap"))

    file = RunFile(runs / "new.mcap", read_run(runs / "alone.mcap").info)
    assert result() == "is being written"
    cut = (runs / "new.mcap").read_bytes()
    file.close()
    assert result() == "unknown"
    (runs / "new.mcap").write_bytes(cut)  # as a copy, or what a killed recorder leaves
    assert result() == "cut off, or being written"


def test_a_damaged_end_gives_no_length_and_no_age(runs):
    path = runs / "alone.mcap"
    data = bytearray(path.read_bytes())
    began = int.from_bytes(data[-28:-20], "little")
    span = data.index(list_times(path), began)
    data[span + 7] ^= 0x40  # the beginning, by decades
    path.write_bytes(data)
    found = next(each for each in list_runs(runs) if each.path == str(path))
    assert (found.length, found.note) == (None, "recording without an end")
    assert found.when == pytest.approx(utc_seconds(), abs=60)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be somebody else for a while")
def test_a_folder_that_may_not_be_read_is_said_and_the_others_are_told(runs, capsys):
    (runs / "run-1").chmod(0)
    for each in [runs, *list(runs.parents)[:-2]]:
        each.chmod(0o755)
    os.seteuid(65534)
    try:
        found = {os.path.basename(each.path): each for each in list_runs(runs)}
        assert found["run-1"].note == "cannot be read: Permission denied"
        assert found["run-2"].length < 1.0  # as its summary knows
        assert remove(runs / "run-1") == "cannot be removed: Permission denied"
        assert run(["report", str(runs / "run-1")]) == 2
    finally:
        os.seteuid(0)
        (runs / "run-1").chmod(0o700)
    assert capsys.readouterr().err.count("\n") == 1


def test_eighty_columns_show_it_whole(runs, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    assert run(["runs", str(runs)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1 + 2 * 4
    assert max(map(len, lines)) <= 80
    assert run(["runs", str(runs), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["runs"]) == 4


@pytest.mark.parametrize(
    "damage", [lambda d: d[:100], lambda d: d[:-40], lambda d: b"", lambda d: b"x" * 500]
)
def test_a_damaged_recording_is_listed_with_a_word(runs, damage):
    path = runs / "run-0" / "run.mcap"
    path.write_bytes(damage(path.read_bytes()))
    os.utime(path, (1e9, 1e9))
    found = next(each for each in list_runs(runs) if each.path.endswith("run-0"))
    assert "recording" in found.note
    assert not found.writing


def test_a_run_of_virtual_time_is_as_old_as_its_name_says(tmp_path):
    """A copy is made now, of all of them."""
    for name in ("20260131-120000-old", "20260201-120000-new", "20260131-180000-middle"):
        (tmp_path / name).mkdir()
        record(tmp_path / name / "run.mcap", 0)
    assert [each.path.rsplit("-", 1)[1] for each in beyond(list_runs(tmp_path), Bounds(number=1))] == [
        "old",
        "middle",
    ]


def test_bounds_take_the_oldest(runs):
    found = list_runs(runs)

    def names(bounds):
        return [os.path.basename(each.path) for each in beyond(found, bounds)]

    assert names(Bounds(number=2)) == ["run-0", "run-1"]
    assert names(Bounds(days=22.5 / 24)) == ["run-0", "run-1"]
    assert names(Bounds(size=found[-1].size + found[-2].size)) == ["run-0", "run-1"]
    assert names(Bounds(number=4)) == []


def test_only_a_run_s_own_files_go(runs, capsys):
    (runs / "run-0" / "thesis.tex").write_text("mine")
    (runs / "link").symlink_to(runs / "run-2")
    assert run(["runs", str(runs), "--prune", "--keep", "0", "--yes"]) == 1
    assert sorted(str(each.relative_to(runs)) for each in runs.rglob("*")) == [
        "file.txt",
        "link",
        "notes",
        "notes/report.html",
        "run-0",
        "run-0/thesis.tex",
    ]
    said = capsys.readouterr().out
    assert "run-0: is gone; other files in its folder stay" in said
    assert "link: is no run of its own" in said


def test_what_is_written_to_stays(runs):
    growing = runs / "growing.mcap"
    growing.write_bytes((runs / "alone.mcap").read_bytes()[:-9])
    held = os.open(runs / "run-1", os.O_RDONLY)
    try:
        fcntl.flock(held, fcntl.LOCK_EX)
        writing = [os.path.basename(each.path) for each in list_runs(runs) if each.writing]
        assert sorted(writing) == ["growing.mcap", "run-1"]
        assert run(["runs", str(runs), "--prune", "--keep", "0", "--yes"]) == 0
        assert remove(runs / "run-1") == remove(growing) == "is being written to"
        assert growing.exists()
        assert (runs / "run-1" / "run.mcap").exists()
        assert not (runs / "run-2").exists()
    finally:
        os.close(held)


def test_it_asks_unless_told(runs, monkeypatch, capsys):
    monkeypatch.setattr("sys.stdin", io.StringIO())
    assert run(["runs", str(runs), "--prune", "--keep", "1"]) == 2
    assert "--yes" in capsys.readouterr().err
    assert len(list_runs(runs)) == 4
