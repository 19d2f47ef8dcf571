"""The leaderboard's page: shares are written as in the tables, and a stranger's method cannot break it."""

import json
import re
import shutil
import subprocess

import pytest

from farhand.trials.leaderboard.plan.board import Board
from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.telling.page import HERE, LONGEST, html
from farhand.trials.leaderboard.telling.tables import bound, percent
from tests.operator_side.console.browser import CHROMIUM, DRIVER, Browser

SHARES = {
    0.0: ("0", "0"),
    1e-6: ("0.1", "0.1"),
    0.0005: ("0.1", "0.1"),
    0.0016: ("0.2", "0.2"),
    0.00999: ("1.0", "1.0"),
    0.01: ("1", "1.0"),
    1 / 8: ("13", "12.5"),
    3 / 8: ("38", "37.5"),
    0.5: ("50", "50.0"),
    5 / 8: ("63", "62.5"),
    0.99: ("99", "99.0"),
    0.9949: ("99.5", "99.5"),
    0.999999: ("99.9", "99.9"),
    1.0: ("100", "100"),
}
"""What a rate and the end of an interval are, in %."""


def test_a_share_in_the_tables():
    assert {share: (percent(share), bound(share)) for share in SHARES} == SHARES


def test_a_share_in_the_page():
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node")
    functions = (HERE / "page.js").read_text(encoding="utf-8").partition("const MEASURES")[0]
    script = functions + f"\nconsole.log(JSON.stringify({list(SHARES)}.map((v) => [pc(v), bound(v)])));"
    done = subprocess.run([node, "-e", script], capture_output=True, text=True, check=True)
    assert [tuple(each) for each in json.loads(done.stdout)] == list(SHARES.values())


def row(method, index, **more):
    names = {"network": "constant", "scene": "passage", "method": method, "operator": "tester"}
    return Row(key=f"{method}/{index}", index=index, seed=index, **names, **more)


ERROR = "ValueError: <!--<script>alert(1)</script>\n" + "x" * 2 * LONGEST
ROWS = [
    row("both", 0, safe=True, success=True, finished=True, min_clearance=-0.02),
    row("both", 1, safe=True, min_clearance=0.02, why="not finished within 68 s: held"),
    row("both", 2, safe=True, why="not finished within 70.5 s: held"),
    row("both", 3, finished=True, violations=1),
    *(row("gone:Class", index, error=ERROR) for index in range(4)),
]


def page(folder):
    board = Board(
        tasks=4,
        networks={"constant": "constant:200"},
        scenes=("passage",),
        methods=("both", "gone:Class"),
        operators=("tester",),
    )
    text = html(board, [], ROWS, folder)
    (folder / "index.html").write_text(text, encoding="utf-8")
    return text


def test_what_a_cell_says_of_runs_that_were_not_done(tmp_path):
    text = page(tmp_path)
    data = json.loads(re.search(r"const BOARD = (.*);\n", text).group(1))
    both, gone = (data["cells"][f"tester|{method}|passage|constant"] for method in data["methods"])
    said = [(data["texts"][number], count) for number, count in both["why"]]
    assert said == [("not finished in time: held", 2), ("something came too near", 1)]
    assert "error" not in both
    assert (both["least"], both["median"], "tool" in both) == (-0.02, 0.0, False)
    ((number, count),) = gone["error"]
    assert (count, gone["n"], gone["crashed"]) == (4, 4, 4)
    assert data["texts"][number].startswith("ValueError: <!--<script>alert(1)</script> xxx")
    assert len(data["texts"][number]) == LONGEST
    assert "why" not in gone


def test_a_command_that_makes_other_runs_as_well_says_so(tmp_path):
    data = json.loads(re.search(r"const BOARD = (.*);\n", page(tmp_path)).group(1))
    assert not any("made" in cell for cell in data["cells"].values())
    board = Board(tasks=4, networks=dict.fromkeys(("constant", "none"), "none"), scenes=("passage", "static"),
                  methods=("both",), operators=("tester",))  # fmt: skip
    data = json.loads(re.search(r"const BOARD = (.*);\n", html(board, [], ROWS[:4], tmp_path)).group(1))
    cells = {key.partition("both|")[2]: cell.get("made") for key, cell in data["cells"].items()}
    assert cells == {"passage|constant": None, "passage|*": 8, "*|constant": 8, "*|*": 16}


def test_a_method_that_is_gone_is_a_name(tmp_path):
    text = page(tmp_path)
    assert "<dt>gone:Class</dt><dd></dd>" in text
    assert "alert(1)</script>" not in text


def test_the_focus_stays_where_it_was(tmp_path):
    if not (CHROMIUM and DRIVER):
        pytest.skip("needs Chromium and its driver")
    page(tmp_path)
    browser = Browser(390, 700)
    try:
        browser.open((tmp_path / "index.html").as_uri())
        for key in ("cell|both|passage|*", "by=networks", "sort=constant", "cell|gone:Class|*|constant"):
            browser.run(f"found({key!r}).focus(); found({key!r}).click()")
            assert browser.run("return document.activeElement.dataset.key") == key
        browser.run("found('measure').focus(); found('measure').dispatchEvent(new Event('change'))")
        assert browser.run("return document.activeElement.dataset.key") == "measure"
        assert "crashed: 4\n4 × ValueError: <!--<script>alert(1)" in browser.text("detail")
        browser.run("found('cell|both|*|*').click()")
        assert "3 of 4 (19.4–99.4 %)" in browser.text("detail")
        assert "−20 and 0 mm" in browser.text("detail")
    finally:
        browser.close()
