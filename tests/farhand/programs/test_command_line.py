"""The programs' words: every option that can be spelled is one that the command has."""

import dataclasses

import pytest
import typer

from farhand.cli import app
from farhand.programs.command_line import (
    CameraWords,
    ConsoleWords,
    NetemWords,
    OperatorWords,
    RecordWords,
    RobotWords,
    SteerWords,
    SummariseWords,
)

ALL = [
    CameraWords,
    ConsoleWords,
    NetemWords,
    OperatorWords,
    RecordWords,
    RobotWords,
    SteerWords,
    SummariseWords,
]


def parameters(kind):
    """The parameters of the real command, by option."""
    command = typer.main.get_command(app).commands[kind.COMMAND]
    return {option: parameter for parameter in command.params for option in parameter.opts}


def fill(kind):
    """One with every field set, to something that can be told apart."""
    values = {}
    for number, field in enumerate(dataclasses.fields(kind)):
        text = str(field.type)
        if text.startswith("tuple"):
            values[field.name] = (f"a{number}", f"b{number}")
        elif "bool" in text:
            values[field.name] = True
        else:
            values[field.name] = str(number)
    return kind(**values), values


@pytest.mark.parametrize("kind", ALL, ids=lambda kind: kind.COMMAND)
def test_every_word_is_an_option_that_the_command_has(kind):
    known = parameters(kind)
    for name, option in kind.options().items():
        assert option in known, f"{kind.__name__}.{name}"
        flag = "bool" in str({field.name: field.type for field in dataclasses.fields(kind)}[name])
        assert known[option].is_flag is flag, option
        many = str({field.name: field.type for field in dataclasses.fields(kind)}[name]).startswith("tuple")
        assert known[option].multiple is many, option


@pytest.mark.parametrize("kind", ALL, ids=lambda kind: kind.COMMAND)
def test_the_command_reads_back_every_value(kind):
    words, values = fill(kind)
    command = typer.main.get_command(app).commands[kind.COMMAND]
    found = command.make_parser(context := typer.Context(command)).parse_args(words.words()[1:])[0]
    assert context is not None
    by_option = {option: found.get(parameter.name) for option, parameter in parameters(kind).items()}
    for name, option in kind.options().items():
        got = tuple(by_option[option]) if isinstance(by_option[option], list) else by_option[option]
        assert got == values[name], option
    for name, argument in ((SummariseWords, "folder"), (SteerWords, "device")):
        if kind is name:
            assert found[argument] == values[argument]


@pytest.mark.parametrize(
    "kind", [CameraWords, NetemWords, OperatorWords, RobotWords], ids=lambda kind: kind.COMMAND
)
def test_what_is_not_said_is_left_out(kind):
    assert kind().words() == [kind.COMMAND]
    assert kind(tls="", insecure=False).words() == [kind.COMMAND]


def test_a_zero_is_said():
    assert NetemWords(seed=0).words() == ["netem", "--seed", "0"]


def test_a_list_is_an_option_for_each():
    words = RobotWords(connect=("tcp/a:1", "tcp/b:2"), settings=("robot.lag=0.1",)).words()
    assert words == ["robot", "--set", "robot.lag=0.1", "--connect", "tcp/a:1", "--connect", "tcp/b:2"]
