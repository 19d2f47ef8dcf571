import csv
import io
import sys

import pyarrow.parquet as pq
import pytest

from farhand.cli import run as run_cli
from farhand.common.errors import InputError
from farhand.laboratory.campaigns.sweep import Sweep

GOOD = """
name = "gamma"
scenario = "point-obstacle"
network = "uniform:50,{high}"
seeds = 2
time_limit = 2.0
[grid]
high = [100, 200]
"controller.gamma" = [0.3, 0.5]
"""


def write(tmp_path, text: str):
    path = tmp_path / "sweep.toml"
    path.write_text(text)
    return path


def test_the_grid_goes_into_scenario_and_network(tmp_path):
    sweep = Sweep(write(tmp_path, GOOD))
    assert len(sweep.jobs) == len({job.key for job in sweep.jobs}) == 8
    last = sweep.jobs[-1]
    assert (str(last.run.network), last.run.seed) == ("uniform:50,200", 1)
    assert last.run.scenario.controller.gamma == 0.5
    assert last.labels == {"high": 200, "controller.gamma": 0.5}


def test_directions_and_random_tasks(tmp_path):
    text = 'scenario = "random-tasks"\nseeds = [4, 9]\n[grid]\nuplink = ["none", "constant:10"]\n'
    jobs = Sweep(write(tmp_path, text)).jobs
    assert [(str(j.run.network), j.run.seed) for j in jobs[2:]] == [
        ("constant:10 / none", 4),
        ("constant:10 / none", 9),
    ]
    obstacles = [job.run.scenario.obstacles for job in jobs]
    assert obstacles[0] == obstacles[2] != obstacles[1]


def test_one_table_as_csv_and_parquet(tmp_path, capsys):
    path = write(tmp_path, GOOD)
    assert run_cli(["sweep", str(path), "--workers", "1", "--out", str(tmp_path / "out")]) == 0
    text = (tmp_path / "out" / "tasks.csv").read_text()
    rows = list(csv.DictReader(io.StringIO(text)))
    table = pq.read_table(tmp_path / "out" / "tasks.parquet")
    assert len(rows) == table.num_rows == 8
    assert table.schema.field("duration").metadata == {b"unit": b"s"}
    assert [float(r["min_clearance [m]"]) for r in rows] == table.column("min_clearance").to_pylist()
    assert table.column("controller.gamma").to_pylist() == [0.3, 0.3, 0.5, 0.5] * 2
    capsys.readouterr()
    # Once more: nothing is left to do, and the bytes stay.
    assert run_cli(["sweep", str(path), "--workers", "1", "--out", str(tmp_path / "out")]) == 0
    assert "8 of 8 runs are there already" in capsys.readouterr().out
    assert (tmp_path / "out" / "tasks.csv").read_text() == text


def test_without_pyarrow_the_csv_is_there_and_one_line_says_what_is_not(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    path = write(tmp_path, GOOD.replace("[100, 200]", "[100]").replace("[0.3, 0.5]", "[0.3]"))
    assert run_cli(["sweep", str(path), "--workers", "1", "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said.count("no tasks.parquet: pyarrow is not installed (pip install 'farhand[parquet]')") == 1
    assert said[-1].endswith("sweep.json, tasks.csv")
    assert sorted(each.name for each in (tmp_path / "out").glob("tasks.*")) == ["tasks.csv"]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (GOOD.replace('"controller.gamma"', '"controller.gama"'), "gama"),
        (GOOD.replace("[0.3, 0.5]", "[0.3, 7.0]"), "controller.gamma = 7.0"),
        (GOOD.replace("high = ", "low = "), "uniform:50,{high}"),
        (GOOD.replace("[100, 200]", "[]"), "grid.high: has no values"),
        (GOOD.replace("[100, 200]", "[100, 100]"), "grid.high: a value is there twice"),
        ('scenario = "point-obstacle"\n[grid]\n', "grid: is empty"),
        ('scenario = "point-obstacle"\n', "grid"),
        (GOOD.replace("seeds = 2", "seeds = 0"), "seeds"),
        (GOOD.replace("seeds = 2", "seeds = [3, 3]"), "seeds: a seed is there twice"),
        (GOOD.replace("seeds = 2", "seeds = 9999999999"), "seeds"),
        (GOOD.replace("seeds = 2", "seeds = 900000"), "3600000 runs; at most"),
        (GOOD.replace("seeds", "sedes"), "sedes"),
        (GOOD.replace("point-obstacle", "moon"), "moon"),
        ("= what", "not valid TOML"),
    ],
)
def test_bad_files_are_refused_in_one_line_that_names_the_key(tmp_path, text, line, capsys):
    path = write(tmp_path, text)
    with pytest.raises(InputError) as refused:
        Sweep(path)
    assert line in str(refused.value)
    out = tmp_path / "out"
    assert run_cli(["sweep", str(path), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["table1", "--delays", "none,lunar"], "'lunar': must be some of none, gaussian"),
        (["table1", "--margins", ","], "names none of none, paper, watchful, adaptive"),
        (["table1", "--robot", "ur5"], "must be point or box"),
        (["table1", "--tasks", "0"], "--tasks"),
        (["table1", "--computing-time", "nan"], "must be from 0 to 10000 ms"),
        (["table1", "--computing-time", "no-such-file"], "no such file"),
        (["table1", "--tasks", "1", "--out", "/proc/nowhere"], "cannot be written"),
        (["sweep", "/no/such.toml"], "cannot be read"),
    ],
)
def test_bad_options_end_with_2_and_one_line(arguments, line, capsys):
    assert run_cli(arguments) == 2
    said = capsys.readouterr().err
    assert line in said
    assert len(said.splitlines()) == 1


def test_computing_times_from_a_text_file(tmp_path, capsys):
    from farhand.laboratory.campaigns.computing_time import read_computing_time

    path = tmp_path / "times.txt"
    path.write_text("# ms\n3.5\n\n20\n")
    assert read_computing_time(str(path)) == (0.0035, 0.02)
    assert read_computing_time("12.5") == (0.0125,)
    path.write_text("3.5\nsoon\n")
    with pytest.raises(InputError, match="line 2: 'soon'"):
        read_computing_time(str(path))
    path.write_text("# nothing\n")
    with pytest.raises(InputError, match="holds no solve"):
        read_computing_time(str(path))
