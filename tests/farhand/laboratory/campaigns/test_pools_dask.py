"""A campaign on a real Dask scheduler with two workers, one of them killed mid-way: nothing lost, nothing twice."""

import os
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from farhand.cli import run as run_cli
from farhand.laboratory.campaigns.campaign import run_campaign
from farhand.laboratory.campaigns.pools import DaskPool, LocalPool
from farhand.laboratory.campaigns.store import ROWS, Store
from farhand.laboratory.campaigns.table1 import Table1

ROOT = Path(__file__).resolve().parents[4]
pytest.importorskip("distributed")


class Program:
    """A Dask program of its own; `line` waits for what it says."""

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]]
        environment = dict(os.environ, PYTHONPATH=str(ROOT), PYTHONWARNINGS="ignore")
        self.process = subprocess.Popen(
            command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env=environment, cwd=ROOT
        )
        self._seen: list[str] = []
        self._found = threading.Condition()
        self._ended = False
        threading.Thread(target=self._read, daemon=True).start()

    def line(self, pattern: str, timeout: float = 60.0) -> str:
        def match() -> str:
            return next((found[0] for line in self._seen if (found := re.search(pattern, line))), "")

        with self._found:
            self._found.wait_for(lambda: match() or self._ended, timeout)
            assert match(), f"{pattern!r} never came: {self._seen}"
            return match()

    def end(self, how: int = signal.SIGTERM) -> None:
        self.process.send_signal(how)
        self.process.wait(30)

    def _read(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            with self._found:
                self._seen.append(line)
                self._found.notify_all()
        with self._found:
            self._ended = True
            self._found.notify_all()
        self.process.stderr.close()


@pytest.fixture
def cluster() -> Iterator[tuple[str, list[Program]]]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1] % 20000 + 10000
    scheduler = Program("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    programs = [scheduler]
    try:
        address = scheduler.line(r"tcp://127\.0\.0\.1:\d+")
        workers = [
            Program(
                "dask_worker",
                address,
                "--nthreads",
                "1",
                "--no-nanny",
                "--no-dashboard",
                "--host",
                "127.0.0.1",
            )
            for _ in range(2)
        ]
        programs += workers
        for worker in workers:
            worker.line("Registered to")
        yield address, workers
    finally:
        for program in reversed(programs):
            if program.process.poll() is None:
                program.end(signal.SIGKILL)


@pytest.mark.realtime
@pytest.mark.slow
def test_a_killed_worker_costs_no_row_and_doubles_none(cluster, tmp_path):
    address, workers = cluster
    jobs = Table1(tasks=8, delays=("constant",), margins=("none", "adaptive"), time_limit=20.0).jobs()
    store = Store(tmp_path / "dask", {"campaign": "test"})
    seen = []

    def kill_one_midway(row) -> None:
        seen.append(row.key)
        if len(seen) == 4:
            workers[0].end(signal.SIGKILL)

    rows = run_campaign(jobs, store, DaskPool(address), kill_one_midway, chunk=1)
    store.close()
    assert workers[0].process.poll() is not None
    assert [row.key for row in rows] == [job.key for job in jobs]
    assert [row.error for row in rows] == [""] * len(jobs)
    assert sorted(seen) == sorted(job.key for job in jobs)
    assert len((tmp_path / "dask" / ROWS).read_text().splitlines()) == len(jobs)
    here = Store(tmp_path / "here", {"campaign": "test"})
    assert run_campaign(jobs, here, LocalPool(1)) == rows
    here.close()


def test_a_scheduler_that_does_not_answer_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("farhand.laboratory.campaigns.pools.ANSWER_TIMEOUT", 0.5)
    out = tmp_path / "out"
    arguments = ["table1", "--tasks", "1", "--scheduler", "tcp://127.0.0.1:9", "--out", str(out), "--json"]
    assert run_cli(arguments) == 2
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("farhand:")]
    assert len(said) == 1
    assert "no Dask scheduler answers" in said[0]
    assert run_cli(["table1", "--tasks", "1", "--scheduler", "nonsense://", "--out", str(out)]) == 2
