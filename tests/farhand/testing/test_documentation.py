"""The example of docs/testing.md, and that its table names all there is."""

import re
from pathlib import Path

import pytest

import farhand.testing

TEXT = (Path(__file__).resolve().parents[3] / "docs" / "testing.md").read_text(encoding="utf-8")
EXAMPLE: dict = {}
exec("".join(re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)), EXAMPLE)
TESTS = sorted(name for name in EXAMPLE if name.startswith("test_"))


@pytest.mark.parametrize("name", TESTS)
def test_the_example_holds(name):
    EXAMPLE[name]()


def test_the_example_is_there_and_every_public_name_is_explained():
    assert len(TESTS) == 2
    named = set(re.findall(r"`(\w+)", TEXT.split("A controller of your own")[0]))
    constants = {name for name in farhand.testing.__all__ if name.isupper()}
    assert set(farhand.testing.__all__) - constants <= named
