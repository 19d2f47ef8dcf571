"""What all tests share: hypothesis without deadlines, and no test that is slow or real by accident."""

import pytest
from hypothesis import HealthCheck, settings

from tests.installed import Environment

# The machine may be loaded: an example that takes long says nothing about the code.
settings.register_profile("farhand", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("farhand")


@pytest.fixture(scope="session")
def installed(tmp_path_factory):
    """Farhand from its wheel in a fresh environment."""
    return Environment(tmp_path_factory.mktemp("installed"))
