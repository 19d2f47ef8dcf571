"""What --help says stands there as it was written: square brackets would be taken for markup and vanish."""

import re

import typer

from farhand.cli import app


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


def test_choices_are_named_in_place_of_a_type():
    demo = dict(commands(typer.main.get_command(app), "farhand"))["farhand demo"]
    metavars = {parameter.name: parameter.metavar for parameter in demo.params}
    assert metavars["margin"] == "none|paper|adaptive"
    assert metavars["solver"] == "newton|sqp|ipopt"
