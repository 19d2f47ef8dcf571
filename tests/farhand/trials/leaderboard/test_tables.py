"""The leaderboard's tables: of runs that crashed nothing is known but that they were neither safe nor done."""

from matplotlib.text import Text

from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.telling.figures import draw_figures
from farhand.trials.leaderboard.telling.labels import Box
from farhand.trials.leaderboard.telling.tables import by_method, millimetres, to_markdown


def row(method, index, **more):
    names = {"network": "constant", "scene": "passage", "method": method, "operator": "tester"}
    return Row(key=f"{method}/{index}", index=index, seed=index, **names, **more)


GOOD = {"safe": True, "success": True, "finished": True, "min_clearance": 0.012, "filtered_share": 0.0004}
TIMES = {"duration": 11.0, "ideal_duration": 10.0, "path_length": 1.2, "ideal_path": 1.0}
ROWS = [
    *(row("both", index, **GOOD, **TIMES) for index in range(7)),
    row("both", 7, error="RuntimeError: no"),
    *(row("theirs", index, error="ValueError: no") for index in range(8)),
]


def test_a_method_that_always_crashed_has_dashes_in_the_terminal():
    table = by_method(ROWS)
    shown = {column.header: list(column.cells) for column in table.columns}
    assert (shown["runs"], shown["safe %"], shown["done %"]) == (["8", "8"], ["88", "0"], ["88", "0"])
    for name in ("evadable", "deepest mm", "least mm", "time", "stops"):
        assert shown[name][1] == "–"
    assert shown["stops"][0] == "0.0"
    assert "95 %" not in str(table.caption)


def test_a_method_that_always_crashed_has_dashes_in_markdown():
    lines = to_markdown(ROWS, [], "farhand benchmark safety").splitlines()
    names = next(line for line in lines if line.startswith("| operator")).strip("| ").split(" | ")
    both, theirs = (
        dict(zip(names, line.strip("| ").split(" | "), strict=True))
        for line in lines
        if line.startswith("| tester")
    )
    assert (both["crashed"], both["safe % (95 %)"], both["way"]) == ("1", "88 (47.3–99.7)", "1.20")
    assert both["filtered %"] == "0.1"
    assert (theirs["crashed"], theirs["safe % (95 %)"]) == ("8", "0 (0–36.9)")
    assert {theirs[name] for name in names[6:]} == {"–"}
    assert "| theirs | – |" in lines
    assert "- theirs: all 8 runs crashed" in lines
    assert "9 of 16 runs crashed." in lines


def test_a_length_below_0_has_a_minus_sign():
    assert [millimetres(length) for length in (-0.0046, -0.0004, 0.0, None)] == ["−5", "−0.4", "0", "–"]


def test_labels_of_points_in_one_place_do_not_lie_on_each_other(tmp_path, monkeypatch):
    placed = []

    def seen(figure, path, **more):
        figure.draw_without_rendering()
        placed.append([Box(*Text.get_window_extent(text).extents) for text in figure.axes[0].texts])

    monkeypatch.setattr("farhand.trials.leaderboard.telling.figures.save", seen)
    rows = [row(f"method-{number}", 0, **GOOD, **TIMES) for number in range(10)]
    draw_figures(rows, tmp_path)
    boxes = placed[0]
    assert len(boxes) == 10
    assert not any(one.meets(other) for one in boxes for other in boxes if one is not other)
