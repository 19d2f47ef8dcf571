"""The live status: nothing that is old has a colour of what is live, and what is gone is said."""

import io
import re

import pytest
from rich.console import Console

from farhand.common.messages.intervention import Intervention
from farhand.common.messages.scene import Obstacle
from farhand.demo.live_status import StatusView
from farhand.demo.report_reader import Arrived
from farhand.demo.scene_words import SceneWords
from farhand.demo.status_drawing import line, render
from farhand.runs.freshness import Ages, picture
from farhand.testing import OPERATOR_SESSION, report, scene

S = 1_000_000_000
BACKGROUND = re.compile(r"\x1b\[(?:\d+;)*4[0-7](?:;\d+)*m")
COLOUR = re.compile(r"\x1b\[(?:\d+;)*[34][0-7](?:;\d+)*m")
DRIVING = {
    "safety": "run",
    "states": 500,
    "state_rate": 101.0,
    "clearance": 0.12,
    "min_clearance": 0.05,
    "target_index": 1,
    "target_count": 3,
    "rtt_mean": 0.12,
    "rtt_std": 0.01,
}


def drawn(ages, connected=True, **fields):
    """The screen as escape codes, and as plain text."""
    console = Console(file=io.StringIO(), force_terminal=True, width=80, color_system="standard")
    shown = picture(ages, connected=connected)
    console.print(render(report(9, **DRIVING | fields), shown, 12.3, "r at here", [0.1, 0.2]))
    codes = console.file.getvalue()
    return codes, re.sub(r"\x1b\[[0-9;]*m", "", codes)


def test_what_is_live_is_coloured():
    codes, text = drawn(Ages(0.1, 0.1))
    assert " RUN " in text
    assert "101 /s" in text
    assert BACKGROUND.search(codes)


@pytest.mark.parametrize("ages", [Ages(2.0, 2.0), Ages(11.0, 11.0), Ages(0.1, 2.0), Ages(0.1, 11.0)])
@pytest.mark.parametrize("mode", ["run", "hold", "stopped"])
def test_what_is_old_is_not_drawn_as_live(ages, mode):
    codes, text = drawn(ages, safety=mode)
    assert f"was {mode}" in text
    assert f" {mode.upper()} " not in text
    assert "101 /s" not in text
    assert "clock stands" in text
    assert f"{max(ages.report, ages.state):.1f} s" in text
    for row in codes.splitlines()[2:]:
        assert not BACKGROUND.search(row), row


def test_what_follows_from_a_robot_that_is_gone_has_no_colour_though_its_operator_lives():
    held = {"held_by": "obstacle 'ball'", "intervening": True, "binding": "ball", "inflation": 0.045}
    live, _ = drawn(Ages(0.1, 0.1), **held)
    gone, text = drawn(Ages(0.1, 11.0), **held)
    assert "was intervening: ball" in text
    assert COLOUR.search(live.splitlines()[0])
    assert not any(COLOUR.search(row) for row in gone.splitlines()[:1] + gone.splitlines()[2:])
    margin = "45 mm beyond the limit"
    assert f"\x1b[2m{margin}" in gone
    assert f"\x1b[2m{margin}" not in live


def test_an_operator_that_is_gone_filters_nothing():
    for fields in ({"intervening": True, "binding": "ball"}, {"status": "infeasible"}, {}):
        codes, text = drawn(Ages(11.0, 11.0), connected=False, **fields)
        assert "OPERATOR GONE: no report for 11.0 s" in text
        assert "was" in text.splitlines()[-1]
        assert not any(BACKGROUND.search(row) for row in codes.splitlines()[3:])


def test_80_columns_show_all_of_it():
    _, text = drawn(Ages(0.1, 0.1), held_by="obstacle 'ball'", safety="hold", safety_reason="x" * 20)
    assert "…" not in text
    assert "no progress: obstacle 'ball'" in text
    assert all(len(row) <= 80 for row in text.splitlines())


def test_what_the_guard_did_and_which_side_is_free_is_drawn_and_written():
    did = Intervention(
        part="forearm", obstacle="post-2", distance=0.031, limit=0.01, asked=0.3, done=0.12, what="slowed"
    )
    _, text = drawn(Ages(0.1, 0.1), guard=did, blocked_by="post-2", free_side="left")
    flat = " ".join(text.split())
    assert "guard slowed: forearm 31 mm from post-2, limit 10 mm" in flat
    assert "blocked by 'post-2': free to the left" in flat
    told = line(report(0, **DRIVING, blocked_by="post-2"), picture(Ages(0.1, 0.1), connected=True), 5.0)
    assert told.endswith("blocked by 'post-2': no side is free")
    # Between two lines of a file it is not forgotten, and not said twice.
    rows = [(1.0, report(1, **DRIVING)), (1.5, report(2, **DRIVING, guard=did)), (1.6, report(3, **DRIVING))]
    rows += [(1.6 + 0.1 * k, report(3 + k, **DRIVING)) for k in range(1, 40)]
    lines = screen(rows)
    assert [("forearm" in text) for text in lines] == [False, True, False]


def test_how_many_obstacles_there_are_and_when_they_changed_last():
    post, ball = Obstacle("post", (0.5, 0.0, 0.2), 0.1), Obstacle("ball", (0.5, 0.4, 0.2), 0.1)
    shown, rows = picture(Ages(0.1, 0.1), connected=True), []
    words = SceneWords()
    came = [
        (scene(0, post), "1 obstacle, as in its scenario"),
        (scene(1, post), "1 obstacle, as in its scenario"),
        (scene(2, post, ball, revision=1), "2 obstacles, changed 5 s ago"),
        (scene(1, post), "2 obstacles, changed 6 s ago"),  # overtaken
        (scene(0, post, session=99), "1 obstacle, changed 5 s ago"),  # the robot's program began anew
    ]
    for at, (each, said) in enumerate(came):
        words.take(each, at * S)
        rows.append((words.words((at + 5) * S), said))
    assert [told for told, _ in rows] == [said for _, said in rows]
    later = SceneWords()
    later.take(came[2][0], 0)
    assert later.words(S) == "2 obstacles, changed before this began"
    assert line(report(0, **DRIVING), shown, 5.0, rows[2][0]).endswith(came[2][1])
    console = Console(file=io.StringIO(), width=80)
    console.print(render(report(0, **DRIVING), shown, 5.0, "r at here", [], later.words(S)))
    assert "changed before this began" in " ".join(console.file.getvalue().split())


def screen(rows, released=0):
    """What a log file gets when (seconds, report or None) happen, and who gave control up."""
    file = io.StringIO()
    with StatusView("r at here", Console(file=file, width=80)) as view:
        for at, arrived in rows:
            news = [Arrived(arrived, round(at * S))] if arrived is not None else []
            view.update(news, round(at * S), connected=True, released=released)
    return file.getvalue().splitlines()


def test_a_log_says_what_is_waited_for_then_drives_then_ages():
    rows = [(0.0, None), (0.5, report(0)), (1.0, report(1, **DRIVING))]
    rows += [(1.0 + 0.1 * k, None) for k in range(1, 150)]
    lines = screen(rows)
    assert "waiting for the operator's first report" in lines[0]
    assert "waiting for the robot's first state" in lines[1]
    assert lines[2].endswith("run")
    assert "no report from the operator for 1.1 s" in lines[3]
    assert "was run" in lines[3]
    assert "OPERATOR GONE: no report for 3.1 s" in lines[4]
    assert "OPERATOR GONE: no report for 13" in lines[5]
    assert not any("run" in text for text in lines[4:])
    assert len(lines) == 6


def test_what_is_around_is_in_a_line_once_and_again_when_it_has_changed():
    post, ball = Obstacle("post", (0.5, 0.0, 0.2), 0.1), Obstacle("ball", (0.5, 0.4, 0.2), 0.1)
    scenes = {20: scene(0, post), 70: scene(1, post), 90: scene(2, post, ball, revision=1)}
    file = io.StringIO()
    with StatusView("r at here", Console(file=file, width=80)) as view:
        for tenth in range(121):
            now_ns = tenth * S // 10
            view.see([(scenes[tenth], now_ns)] if tenth in scenes else [])
            why = {"stop_reason": "asking for control"} if tenth < 30 else {}  # stands behind it in the line
            driving = report(tenth, **DRIVING | {"states": tenth + 1} | why)
            view.update([Arrived(driving, now_ns)], now_ns, connected=True)
    told = [text.partition("obstacle")[2].partition("  ")[0] for text in file.getvalue().splitlines()]
    assert told == ["", ", as in its scenario", "", "", "", "s, changed 1 s ago", "s, changed 3 s ago"]


def test_a_device_that_asks_for_nothing_is_explained():
    for index, said in ((1, "nothing is asked of the robot"), (2, "all targets are reached")):
        idle = {"stop_reason": "device not engaged", "target_index": index, "target_count": 2}
        told = line(report(0, **DRIVING | idle), picture(Ages(0.1, 0.1), connected=True), 5.0)
        assert told.endswith(f"device not engaged: {said}")
        _, text = drawn(Ages(0.1, 0.1), **idle)
        assert f"device not engaged: {said}" in " ".join(text.split())


@pytest.mark.parametrize(
    ("session", "index", "said"),
    [
        (OPERATOR_SESSION, 2, "the operator finished, all 2 targets: it gave control up 1.1 s ago"),
        (OPERATOR_SESSION, 1, "the operator ended before the last target: it gave control up 1.1 s ago"),
        (OPERATOR_SESSION + 1, 2, "no report from the operator for 1.1 s"),
    ],
)
def test_an_operator_that_gave_control_up_has_ended_and_is_not_gone(session, index, said):
    last = DRIVING | {"target_index": index, "target_count": 2}
    lines = screen([(0.0, report(0, **last)), *((0.1 * k, None) for k in range(1, 60))], session)
    assert said in lines[1]
    ended = session == OPERATOR_SESSION
    assert any("GONE" in text for text in lines) is not ended
    assert any("was run" in text for text in lines) is not ended


def test_a_line_of_a_file_does_not_wrap():
    long = report(0, **DRIVING, stop_reason="word " * 60)
    assert len(screen([(0.0, long)])) == 1


def test_no_value_of_what_is_gone_is_in_a_line():
    assert line(report(0, **DRIVING), picture(Ages(0.1, 9.0)), 5.0).endswith("is silent")
