"""What --help says stands there as it was written, whole in 80 columns, and in words instead of Python's types."""

import inspect
import itertools
import re

import pytest
import typer

from farhand.cli import app, run
from farhand.operator_side.steering.hand.remote import Remote
from farhand.operator_side.steering.registry import BY_HAND, DEVICES


def commands(group, path):
    for name, command in getattr(group, "commands", {}).items():
        yield from commands(command, f"{path} {name}")
    yield path, group


COMMANDS = dict(commands(typer.main.get_command(app), "farhand"))
PATHS = list(COMMANDS)


def helped(path, width, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(width))
    monkeypatch.setenv("TERMINAL_WIDTH", str(width))
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", width)
    assert run([*path.split()[1:], "--help"]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("path", PATHS)
def test_no_word_of_a_help_is_lost_and_no_default_said_twice(path, monkeypatch, capsys):
    """Neither what is in brackets, which may look like markup, nor a paragraph's end."""
    said = " ".join(helped(path, 1000, monkeypatch, capsys).replace("│", "").split())
    written = [COMMANDS[path].help, *(getattr(param, "help", None) for param in COMMANDS[path].params)]
    for text in filter(None, written):
        for paragraph in inspect.cleandoc(text).split("\n\n"):
            assert " ".join(paragraph.split()) in said
    assert not re.search(r"\(default:[^│]*?\) \[default:", said)


@pytest.mark.parametrize("path", PATHS)
def test_a_paragraph_is_broken_only_where_its_line_is_full(path, monkeypatch, capsys):
    prose = helped(path, 80, monkeypatch, capsys).split("╭")[0].split("Usage:")[1]
    for paragraph in re.split(r"\n\s*\n", prose)[1:]:
        lines = [line.strip() for line in paragraph.splitlines() if line.strip()]
        for line, following in itertools.pairwise(lines):
            assert len(line) + 1 + len(following.split()[0]) > 78, (line, following)


@pytest.mark.parametrize("path", PATHS)
def test_help_is_whole_in_80_columns(path, monkeypatch, capsys):
    said = helped(path, 80, monkeypatch, capsys)
    assert max(map(len, said.splitlines())) <= 80
    assert "…" not in said
    assert not re.search(r"<(bool|str|int|float|path|list)|x<=|<=x|\de[+]\d", said)


def test_choices_are_named_whole(monkeypatch, capsys):
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 80)
    for command in ("demo", "simulate", "operator"):
        assert run([command, "--help"]) == 0
        said = capsys.readouterr().out.split()
        for choice in ("none", "paper", "adaptive", "last-command", "timeline", "newton", "ipopt", "tester"):
            assert choice in said
        assert "KEY=VALUE" in said


def test_virtual_time_offers_no_hand(monkeypatch, capsys):
    by_hand = {name for name in DEVICES.names() if issubclass(DEVICES.get(name), Remote)}
    assert by_hand == set(BY_HAND)
    assert not by_hand & set(re.findall(r"[\w-]+", helped("farhand simulate", 80, monkeypatch, capsys)))
