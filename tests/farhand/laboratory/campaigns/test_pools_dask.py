"""A campaign on a real Dask scheduler with two workers, one of them killed mid-way: nothing lost, nothing twice."""

import re
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from farhand.cli import run as run_cli
from farhand.common.link.ports import free_ports
from farhand.laboratory.campaigns.campaign import run_campaign
from farhand.laboratory.campaigns.pools import DaskPool, LocalPool
from farhand.laboratory.campaigns.store import ROWS, Store
from farhand.laboratory.campaigns.table1 import Table1
from farhand.testing import Program

ROOT = Path(__file__).resolve().parents[4]
pytest.importorskip("distributed")


ADDRESS = re.compile(r"tcp://127\.0\.0\.1:\d+")


def dask(kind: str, *arguments: str) -> Program:
    """A program of Dask's."""
    environment = {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"}
    return Program(*arguments, module=f"distributed.cli.dask_{kind}", environment=environment)


@pytest.fixture
def cluster() -> Iterator[tuple[str, list[Program]]]:
    host = ("--host", "127.0.0.1", "--no-dashboard")
    with ExitStack() as stack:
        port = str(free_ports(1)[0])
        scheduler = stack.enter_context(dask("scheduler", *host, "--port", port))
        said = scheduler.wait_for_line(lambda line: ADDRESS.search(line) is not None)
        found = ADDRESS.search(said)
        assert found is not None
        limits = ("--nthreads", "1", "--no-nanny")
        workers = [stack.enter_context(dask("worker", found[0], *limits, *host)) for _ in range(2)]
        for worker in workers:
            worker.wait_for("Registered to")
        yield found[0], workers


@pytest.mark.long
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
            workers[0].close()

    rows = run_campaign(jobs, store, DaskPool(address), kill_one_midway, chunk=1)
    store.close()
    assert not workers[0].alive
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
