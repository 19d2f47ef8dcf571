"""What is tried in `make test`, and what is tried in `make test-long` as well."""

import os
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import settings

THOROUGH = os.environ.get("FARHAND_TESTS") == "thorough"


def tries(number: int, of: int, **more: Any) -> Callable[[Any], Any]:
    """Settings of a property that is tried `number` times, and `of` times where tests are thorough."""
    tried = settings(max_examples=of if THOROUGH else number, deadline=None, **more)
    return lambda test: pytest.mark.thorough(tried(test))


def also(*values: Any) -> Any:
    """Parameters of a case that is tried by `make test-long` alone: another one shows nearly the same."""
    return pytest.param(*values, marks=pytest.mark.long)
