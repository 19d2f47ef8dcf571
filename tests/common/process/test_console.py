"""Tables for people: whole in 80 columns, whatever is in them, and unbroken in a file."""

import io
import re
from pathlib import Path

import pytest
from rich.console import Console
from rich.table import Table

from farhand.common.process.console import FILE_WIDTH, page, whole

REPOSITORY = Path(__file__).parents[3]


def drawn(table: Table, width: int) -> str:
    console = Console(file=io.StringIO(), width=width)
    console.print(whole(table, console))
    return console.file.getvalue()


def a_table(headings: list[str], rows: list[list[str]], **column) -> Table:
    table = Table(title="a title", caption="what it means")
    for heading in headings:
        table.add_column(heading, **column)
    for row in rows:
        table.add_row(*row)
    return table


WIDE = ["high", "controller.gamma", "margin.kind", "success (95 % interval)", "least, median clearance (mm)"]
ROW = ["100", "0.3", "adaptive", "100 % (97.5–100.0)", "1709.0, 1744.8"]


@pytest.mark.parametrize("width", [200, 100, 80, 60, 40, 24])
def test_no_word_is_cut_at_any_width(width):
    said = drawn(a_table(WIDE, [ROW, ROW]), width)
    assert max(map(len, said.splitlines())) <= width
    assert "…" not in said
    for word in " ".join([*WIDE, *ROW]).split():
        assert word in said.split() or width == 24


def test_what_fits_keeps_its_frame_and_what_does_not_becomes_lists():
    assert "┃" in drawn(a_table(WIDE, [ROW]), 140)
    framed, bare, lists = (drawn(a_table(WIDE, [ROW, ROW]), width) for width in (90, 60, 40))
    assert "┃" in framed
    assert "┃" not in bare
    assert "─" in bare
    assert [line.split()[0] for line in lists.splitlines() if line.startswith("high")] == ["high", "high"]
    assert "a title" in lists
    assert "what it means" in lists


def test_a_column_that_may_be_broken_anywhere_gives_way():
    long = "trace:" + "x" * 90
    said = drawn(a_table(["network", "received"], [[long, "12"]], overflow="fold"), 40)
    assert said.count("x") == 90
    assert max(map(len, said.splitlines())) <= 40


def test_a_file_has_unbroken_lines_unless_columns_are_asked_for(monkeypatch, capsys):
    monkeypatch.delenv("COLUMNS", raising=False)
    page().print("word " * 100)
    assert capsys.readouterr().out.count("\n") == 1
    assert page().width == FILE_WIDTH
    monkeypatch.setenv("COLUMNS", "80")
    assert page().width == 80


def test_what_is_in_brackets_is_printed_as_it_stands(capsys):
    words = "[steering.gamepad] [bold] [/x] trace:[red]delays.csv"
    table = Table("heading [bold]", title=words)
    table.add_row(words)
    page().print(words)
    page().print(whole(table, page()))
    assert capsys.readouterr().out.count(words) == 3


def test_no_console_of_the_program_reads_markup():
    """One made elsewhere than by `page` says so as well."""
    for root in ("common", "netem", "operator_side", "robot_side", "farhand", "benchmarks"):
        for file in (REPOSITORY / root).rglob("*.py"):
            text = file.read_text()
            assert "rich.markup" not in text or file.name == "help_words.py", file  # which Typer prints
            if "rich.console import" in text:
                for made in re.findall(r"\bConsole\([^\n]*", text):
                    assert "markup=False" in made, f"{file}: {made}"
