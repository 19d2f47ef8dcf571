"""A short recorded run in virtual time, made once."""

import io

import pytest

from farhand.laboratory.simulation import simulate


class InMemory:
    """In place of a path: thousands of files on disk would take long."""

    def __init__(self, data):
        self.data = data

    def open(self, mode):
        return io.BytesIO(self.data)


@pytest.fixture(scope="session")
def recorded(tmp_path_factory):
    """Path and result of three seconds past an obstacle over a network that loses messages."""
    path = tmp_path_factory.mktemp("recorded") / "run.mcap"
    result = simulate("point-obstacle", network="5g-urban", record_to=path, time_limit=3.0, keep_reports=True)
    return path, result


@pytest.fixture(scope="session")
def in_memory():
    return InMemory
