"""Campaigns: they go on where they stopped, outlive crashes, and give the same bytes however they are run."""

import errno
import io
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import msgspec
import pytest
from rich.console import Console

from farhand.cli import run
from farhand.common.errors import InputError
from farhand.laboratory.campaigns import jobs as jobs_module
from farhand.laboratory.campaigns.campaign import run_campaign
from farhand.laboratory.campaigns.jobs import Job, run_job
from farhand.laboratory.campaigns.pools import LocalPool
from farhand.laboratory.campaigns.run_table1 import _tell_the_file
from farhand.laboratory.campaigns.store import CAMPAIGN, ROWS, Store
from farhand.laboratory.campaigns.table1 import Table1, cells
from tests.examples import also

ROOT = Path(__file__).resolve().parents[4]
ABOUT = {"campaign": "test", "seed": 1}


@pytest.fixture
def jobs() -> list[Job]:
    """Six runs, short ones."""
    table = Table1(tasks=2, delays=("constant",), time_limit=2.0)
    return table.jobs()


def dying(job: Job):
    """In place of the simulation: takes its whole process with it for one task."""
    if job.key.endswith("paper/1"):
        os._exit(9)
    return run_job(job)


def run_in_dying_workers(chunk: list[Job]):
    return [dying(job) for job in chunk]


@pytest.mark.long
def test_one_and_two_fresh_workers_give_the_same_csv(tmp_path, capsys):
    tables = []
    # A task alone draws no figures; its row is the same.
    for workers, which in ((1, ["--tasks", "1"]), (2, ["--task", "0"])):
        out = tmp_path / str(workers)
        command = ["table1", *which, "--delays", "gaussian", "--margins", "none,adaptive"]
        assert run([*command, "--workers", str(workers), "--out", str(out)]) == 0, capsys.readouterr().err
        tables.append((out / "tasks.csv").read_bytes())
    written = {path.name for path in (tmp_path / "1").iterdir()}
    assert {"table1.json", "table1.md", "path.png", "path.pdf", "clearance.png", "boxes.png"} <= written
    assert tables[0] == tables[1]
    header, first = tables[0].decode().splitlines()[:2]
    assert "min_clearance [m]" in header
    assert "duration [s]" in header
    assert first.startswith("gaussian,none,0,point,")


def test_a_stopped_campaign_goes_on_where_it_stopped(tmp_path, jobs):
    store = Store(tmp_path, ABOUT)
    done = [run_job(job) for job in jobs[:4]]
    for row in done:
        assert store.add(row)
    store.close()
    # The power failed in the middle of a line.
    path = tmp_path / ROWS
    path.write_bytes(path.read_bytes()[:-20])
    store = Store(tmp_path, ABOUT)
    assert len(store.rows) == 3
    ran = []
    rows = run_campaign(jobs, store, LocalPool(1), ran.append, chunk=1)
    store.close()
    assert [row.key for row in ran] == [job.key for job in jobs[3:]]
    assert [row.key for row in rows] == [job.key for job in jobs]
    assert rows[3] == done[3]
    assert len(path.read_text().splitlines()) == 6


def test_no_row_is_kept_twice(tmp_path, jobs):
    store = Store(tmp_path, ABOUT)
    row = run_job(jobs[0])
    assert store.add(row)
    assert not store.add(row)
    store.close()
    assert len((tmp_path / ROWS).read_text().splitlines()) == 1


def test_another_campaign_is_not_mixed_in(tmp_path):
    Store(tmp_path, ABOUT).close()
    with pytest.raises(InputError, match="holds another campaign \\(seed was 1, now 2\\)"):
        Store(tmp_path, ABOUT | {"seed": 2})
    Store(tmp_path, ABOUT | {"selection": {"tasks": 9}}).close()  # more of the same
    (tmp_path / CAMPAIGN).write_text("not JSON")
    with pytest.raises(InputError, match="unreadable"):
        Store(tmp_path, ABOUT)


def test_a_crash_is_a_row_with_its_seed(tmp_path, jobs, monkeypatch):
    def explode(*_args, **_kwargs):
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr(jobs_module, "simulate_run", explode)
    row = run_job(jobs[2])
    assert row.error == "ZeroDivisionError: of all things"
    assert (row.key, row.seed, row.success) == (jobs[2].key, jobs[2].run.seed, False)
    assert cells([row])["constant", "paper"].crashed == 1


@pytest.mark.long
def test_a_job_that_kills_its_process_costs_one_row(tmp_path, jobs, monkeypatch):
    monkeypatch.setattr("farhand.laboratory.campaigns.campaign.run_jobs", run_in_dying_workers)
    store = Store(tmp_path, ABOUT)
    rows = run_campaign(jobs, store, LocalPool(2), chunk=2)
    store.close()
    assert [row.key for row in rows] == [job.key for job in jobs]
    errors = {row.key: row.error for row in rows if row.error}
    assert list(errors) == ["constant/paper/1"]
    assert "died" in errors["constant/paper/1"]


def test_any_row_can_be_run_again_alone(jobs):
    table = Table1(tasks=200, delays=("constant",), time_limit=2.0)
    again = msgspec.structs.replace(table.job("constant", "paper", 1))
    assert run_job(again) == run_job(jobs[3])
    assert Table1(only=17).indices == (17,)


def test_measured_computing_times_are_drawn_the_same_every_time(jobs):
    run = msgspec.structs.replace(jobs[0].run, computing_time=(0.005, 0.02, 0.06))
    drawn = msgspec.structs.replace(jobs[0], run=run)
    first, second = run_job(drawn), run_job(drawn)
    assert first == second
    assert first.rtt_std > run_job(jobs[0]).rtt_std


def test_the_pool_stops_and_keeps_what_is_finished_when_interrupted(tmp_path, jobs):
    store = Store(tmp_path, ABOUT)

    def interrupt(_row):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_campaign(jobs, store, LocalPool(1), interrupt, chunk=1)
    store.close()
    kept = (tmp_path / ROWS).read_text().splitlines()
    assert len(kept) == 1
    assert json.loads(kept[0])["key"] in {job.key for job in jobs}  # whichever was heard of first
    assert multiprocessing.active_children() == []


class Full:
    """A stream on a disk that fills up after some rows."""

    def __init__(self, stream, rows):
        self.stream, self.left, self.close = stream, rows, stream.close

    def write(self, text):
        if self.left == 0:
            self.stream.write(text[:10])
            raise OSError(errno.ENOSPC, "No space left on device")
        self.left -= 1
        self.stream.write(text)

    def flush(self):
        self.stream.flush()


def test_a_full_disk_costs_going_on_and_not_the_campaign(tmp_path, jobs):
    store = Store(tmp_path, ABOUT)
    store._stream = Full(store._stream, 2)
    rows = run_campaign(jobs, store, LocalPool(1), chunk=3)
    assert [row.key for row in rows] == [job.key for job in jobs]
    assert store.write_table(rows).exists()
    store.close()
    assert (
        "rows.jsonl: cannot be written: No space left on device; such a campaign cannot go on"
        in store.trouble
    )
    again = Store(tmp_path, ABOUT)  # half a line at the end is dropped
    assert len(again.rows) == 2
    again.close()


@pytest.mark.realtime
@pytest.mark.parametrize("number", [also(signal.SIGINT), also(signal.SIGTERM), signal.SIGHUP])
def test_a_signal_to_the_group_ends_a_campaign_in_one_line(tmp_path, number):
    """As a terminal sends it that is closed: to the workers and to the resource tracker of Python as well."""
    command = [
        sys.executable,
        "-m",
        "farhand",
        "table1",
        "--tasks",
        "40",
        "--delays",
        "none",
        "--margins",
        "none",
        "--workers",
        "2",
        "--out",
        str(tmp_path),
    ]
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as program:
        rows, pause, waited = tmp_path / ROWS, threading.Event(), 0
        while not (rows.exists() and rows.stat().st_size) and waited < 600:
            pause.wait(0.1)
            waited += 1
        os.killpg(program.pid, number)
        out, errors = program.communicate(timeout=60)
    assert program.returncode == 130
    assert errors == ""
    kept = len(rows.read_text().splitlines())
    assert f"interrupted: {kept} of 40 runs are kept in" in " ".join(out.split())
    assert len((tmp_path / "tasks.csv").read_text().splitlines()) == kept + 1


def test_a_log_is_told_now_and_then_how_far_a_long_campaign_is():
    said = io.StringIO()
    for done in range(21, 201):
        task = SimpleNamespace(total=200, completed=done, elapsed=3.0 * (done - 20))
        _tell_the_file(task, 20, "running", Console(file=said, width=200))
    lines = said.getvalue().splitlines()
    assert len(lines) == 44  # every fourth, but for the last
    assert lines[0] == "running: 24 of 200, 0.2 min elapsed, 8.8 left"
