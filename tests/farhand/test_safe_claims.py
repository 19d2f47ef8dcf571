"""What README and the architecture call safe points to where it was measured, and what it points to is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = ("README.md", "docs/architecture.md")
CLAIM = re.compile(
    r"\bsafe(ly)?\b|\bhitting\b|cannot hit|never hit|\bkeeps (the tool|every link|the whole)", re.IGNORECASE
)
LINK = re.compile(r"\]\(([^()\s]+\.md#[a-z0-9-]+)\)")
ALLOWED = {
    "Exit code 0 means safe and finished": "what the word means: of that very run, as it was measured",
    "## What keeps the robot safe": "the heading of the table whose rows are looked at one by one",
    "then the guard (`guard/`) keeps the whole body clear": "where it stands; what it does is a row of that table",
    "It is not a certified safety system": "says what it is not",
}
"""Parts of lines that say `safe` and point nowhere, and why they may."""


def slugs(path):
    """The anchors of a page, as GitHub makes them."""
    heads = re.findall(r"(?m)^#+ (.+)$", path.read_text(encoding="utf-8"))
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def lines(page):
    return (ROOT / page).read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("page", PAGES)
def test_what_is_called_safe_points_to_a_row(page):
    found = lines(page)
    bare = []
    for number, line in enumerate(found):
        if CLAIM.search(line) and not any(part in line for part in ALLOWED):
            near = " ".join(found[number : number + 2])  # a sentence may end in the next line
            if not LINK.search(near):
                bare.append(f"{page}, line {number + 1}: {line}")
    assert bare == []


@pytest.mark.parametrize("page", PAGES)
def test_what_is_pointed_to_is_there_and_has_a_table(page):
    folder = (ROOT / page).parent
    for target in LINK.findall("\n".join(lines(page))):
        name, _, anchor = target.partition("#")
        path = folder / name
        assert anchor in slugs(path), target


def test_every_layer_says_where_it_was_measured():
    text = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    table = text.partition("## What keeps the robot safe")[2].strip().split("\n\n")[0].splitlines()
    assert len(table) > 8
    for row in table[2:]:
        target = LINK.search(row.rsplit("|", 2)[1])
        assert target, row
        name, _, anchor = target.group(1).partition("#")
        section = _section(ROOT / "docs" / name, anchor)
        assert "|---|" in section, f"{target.group(1)} has no table"


def _section(path, anchor):
    parts = re.split(r"(?m)^(#+ .+)$", path.read_text(encoding="utf-8"))
    for head, body in zip(parts[1::2], parts[2::2], strict=True):
        if re.sub(r"[^\w\- ]", "", head.lstrip("# ").lower()).replace(" ", "-") == anchor:
            return body
    raise AssertionError(f"{path.name} has no #{anchor}")


def test_no_reason_is_left_over():
    whole = "\n".join(line for page in PAGES for line in lines(page))
    assert [part for part in ALLOWED if part not in whole] == []
