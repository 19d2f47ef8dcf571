"""What all tests share: hypothesis without deadlines, and no test that is slow or real by accident."""

from hypothesis import HealthCheck, settings

# The machine may be loaded: an example that takes long says nothing about the code.
settings.register_profile("farhand", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("farhand")
