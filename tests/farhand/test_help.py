"""What --help says stands there as it was written, whole in 80 columns, and in words instead of Python's types."""

import re

import pytest
import typer

from farhand.cli import app, run


def commands(group, path):
    for name, command in getattr(group, "commands", {}).items():
        yield from commands(command, f"{path} {name}")
    yield path, group


def test_no_help_is_taken_for_markup():
    found = list(commands(typer.main.get_command(app), "farhand"))
    assert len(found) > 20
    for path, command in found:
        for parameter in command.params:
            text = getattr(parameter, "help", None) or ""
            assert not re.search(r"\[[a-z#/@]", text), f"{path} {parameter.name}: {text}"


PATHS = [path for path, _ in commands(typer.main.get_command(app), "farhand")]


@pytest.mark.parametrize("path", PATHS)
def test_help_is_whole_in_80_columns(path, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TERMINAL_WIDTH", "80")
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 80)
    assert run([*path.split()[1:], "--help"]) == 0
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 80
    assert "…" not in said
    assert not re.search(r"<(bool|str|int|float|path|list)|x<=|<=x", said)


def test_choices_are_named_whole(monkeypatch, capsys):
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 80)
    for command in ("demo", "simulate", "operator"):
        assert run([command, "--help"]) == 0
        said = capsys.readouterr().out.split()
        for choice in ("none", "paper", "adaptive", "last-command", "timeline", "newton", "ipopt", "tester"):
            assert choice in said
        assert "KEY=VALUE" in said
