"""What `farhand trace fit` says to use is what shell and emulator read."""

import shlex

import pytest

from farhand.commands.emulation.traces import as_word
from farhand.netem.spec import parse_spec


@pytest.mark.parametrize("name", ["plain.toml", "my model, x.toml", "it's.toml"])
def test_a_model_s_file_is_named_as_shell_and_emulator_read_it(name):
    (spec,) = shlex.split(as_word(name))
    assert str(parse_spec(spec)).replace('"', "") == f"model:{name}"
