"""What all tests with real programs need: programs that end with the test, a short task, a place to meet."""

import pytest

from farhand.common.link.ports import free_ports
from farhand.testing import Programs, short_task


@pytest.fixture
def started(tmp_path):
    """Starts a program by its words (see command_line.py); the logs are in the test's folder."""
    with Programs(tmp_path) as programs:
        yield lambda words: programs.start(*words.words())


@pytest.fixture
def scenario(tmp_path):
    return str(short_task(tmp_path))


@pytest.fixture
def endpoint():
    return f"tcp/127.0.0.1:{free_ports(1)[0]}"
