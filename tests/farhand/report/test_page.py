"""The page: one file that needs nothing, says what is missing, and sets two runs side by side."""

import dataclasses
import re
import shutil
from xml.etree import ElementTree

import msgspec
import numpy as np
import pytest

from farhand.cli import run
from farhand.common.recording.records import RunInfo
from farhand.common.recording.run_file import RunFile
from farhand.laboratory.simulation import simulate
from farhand.operator_side.sensing.state_loss import COUNTED
from farhand.report.drawing.svg import WIDTH, Chart, Line, drawn
from farhand.report.page import Page
from farhand.report.reading.evidence import Evidence, _compare, read_evidence
from farhand.report.reading.figures import figures_of
from farhand.runs.summary import write_summary
from farhand.testing import report
from tests.farhand.report.test_story import told as story_of


@pytest.fixture
def folder(recorded, tmp_path):
    """A run's folder."""
    path, result = recorded
    shutil.copy(path, tmp_path / "run.mcap")
    write_summary(result.summary, tmp_path)
    return tmp_path


def test_it_needs_nothing_else_and_is_small(folder):
    html = Page([read_evidence(folder)]).html()
    assert len(html) < 1e6
    assert not re.search(r"https?://|src=|@import|url\(", html)
    assert "What is missing" not in html
    for drawing in re.findall(r"<svg.*?</svg>(?=<)", html.split("<script")[0]):
        if drawing.count("<svg") == drawing.count("</svg>"):
            ElementTree.fromstring(drawing)


def test_it_tells_how_it_went_by_the_summary(folder, recorded):
    html, summary = Page([read_evidence(folder)]).html(), recorded[1].summary
    assert f"{summary.min_clearance * 1e3:.1f} mm" in html
    assert "NOT FINISHED" in html
    assert ">SAFE<" in html
    assert "in virtual time" in html
    assert "not measured in virtual time" in html


def test_a_recording_alone_knows_no_verdict(recorded):
    html = Page([read_evidence(recorded[0])]).html()
    assert "SAFE OR NOT: UNKNOWN" in html
    assert "this is the recording alone" in html


def test_a_recording_alone_names_a_summary_where_there_is_one(folder, tmp_path):
    def said():
        return next(each for each in read_evidence(folder / "run.mcap").lacks if "recording alone" in each)

    assert said().endswith(f"for these give the folder, {folder.name}, which has a summary.json")
    (folder / "summary.json").unlink()
    assert said().endswith("are not in it, and beside it is nothing that has them")


def test_a_summary_of_another_run_is_left_out_and_told(folder, recorded):
    write_summary(msgspec.structs.replace(recorded[1].summary, seed=99), folder)
    found = read_evidence(folder)
    assert found.summary is None
    assert "summary.json is of another run than the recording: it was left out" in found.lacks


@pytest.mark.parametrize("content", ["{", "", "[]", '{"safe": 1}', "\xff"])
def test_a_broken_summary_is_told(folder, content):
    (folder / "summary.json").write_text(content, encoding="latin-1")
    found = read_evidence(folder)
    assert any(line.startswith("summary.json cannot be read") for line in found.lacks)


def test_a_run_that_counted_more_ticks_than_were_recorded_is_told(folder, recorded):
    write_summary(msgspec.structs.replace(recorded[1].summary, ticks=999), folder)
    assert any("the run had 999" in line for line in read_evidence(folder).lacks)


def test_of_a_recording_that_lacks_most_each_figure_has_one_source(recorded):
    """A recording of the wait alone, beside the results of a run that finished."""
    summary = recorded[1].summary
    counts = msgspec.structs.replace(
        summary.counts, robot=msgspec.structs.replace(summary.counts.robot, refused={"stale": 4})
    )
    summary = msgspec.structs.replace(
        summary, finished=True, targets_reached=3, targets=3, counts=counts, ticks=229, scenario="x", seed=1
    )
    found = Evidence("x", story_of([report(n, mode="hold", target_count=3) for n in range(5)]))
    _compare(found, summary)
    html, figures = Page([found]).html(), figures_of(found)
    took, near = f"{summary.duration:.1f} s", f"{summary.min_clearance * 1e3:.1f} mm"
    assert f"3 of 3 targets in {took} by the operator" in html
    assert f"least clearance {near} (limit 50 mm) by the robot" in html
    assert "<td>never</td>" not in html
    assert "<td>held, or commanded zero</td><td>unknown</td>" in html
    assert "<td>refusals by the robot</td><td>4 commands: stale 4 (robot&#x27;s result)</td>" in html
    assert (figures.whole, figures.targets_reached, figures.recorded) == (False, 3, pytest.approx(0.4))
    assert figures.sources["clearance"] == "robot's result"
    assert not any("nothing is known" in line for line in found.lacks)


def test_refusals_that_no_recorded_state_tells_of_are_told_by_reason(folder, recorded):
    """As of a command that came after the last state that was recorded."""
    summary = recorded[1].summary
    refused = {"stale": 1, "old-seq": 2}
    robot = msgspec.structs.replace(summary.counts.robot, refused=refused)
    counts = msgspec.structs.replace(summary.counts, robot=robot)
    write_summary(msgspec.structs.replace(summary, counts=counts), folder)
    found = read_evidence(folder)
    assert "refused" not in figures_of(found).happened
    assert figures_of(found).refused_by == refused
    html = Page([found]).html()
    assert "<td>refusals by the robot</td><td>3 commands: old-seq 2, stale 1 (robot" in html
    assert "The robot refused 3 commands: old-seq 2, stale 1 (old-seq: not newer than" in html
    assert "no refusal" not in html


def test_of_a_recording_that_is_not_whole_no_figure_is_told_as_of_all_of_it(recorded):
    """What was not recorded may have held a stop, and something nearer."""
    story = read_evidence(recorded[0]).story
    html = Page([Evidence("x", story)]).html()
    near = f"<td>clearance of the tool, least</td><td>{story.least * 1e3:.1f} mm"
    assert f"{near}</td>" in html
    assert "<td>stops of the robot</td><td>none</td>" in html
    story = dataclasses.replace(story, whole=False)
    html = Page([Evidence("x", story)]).html()
    assert f"{near} as recorded</td>" in html
    assert "<td>stops of the robot</td><td>unknown</td>" in html
    story = dataclasses.replace(story, last=msgspec.structs.replace(story.last, stops=2))
    assert "<td>stops of the robot</td><td>2 as recorded</td>" in Page([Evidence("x", story)]).html()


def test_the_figures_of_the_axes_can_be_read_on_a_phone(folder):
    """Text is in the chart's units; those of a vertical axis that are shown stand apart."""
    html = Page([read_evidence(folder)]).html()
    phone = html.split("max-width: 560px")[1].split("@media")[0]
    size = float(re.search(r"svg\.chart text \{ font-size: (\d+)px", phone).group(1))
    assert size * (390 - 30) / WIDTH > 10.0
    assert ".between { display: none; }" in phone
    for chart in re.findall(r'<svg class="chart" .*?</svg>', html):
        shown = [float(y) for y in re.findall(r'class="tick" x="40" y="([\d.]+)"', chart)]
        assert min(-np.diff(shown), default=size) >= 0.9 * size


def test_loss_and_age_are_called_what_they_are(folder):
    """The window of the loss is one of time; what is as old as its way was is not shown."""
    html = Page([read_evidence(folder)]).html()
    assert f"states lost in {COUNTED:g} s, up to 1 s ago" in html
    assert (COUNTED, "of the last 200" in html) == (3.0, False)
    assert html.count("since the newest state came") == 2  # of the chart and of the table
    assert "age of the newest state" not in html


def test_what_the_emulator_counted_beyond_the_recording_is_said(folder, recorded):
    """As where messages were on the way before the operator's first tick and after its last."""
    summary = recorded[1].summary
    netem, recorded_way = summary.counts.netem, figures_of(read_evidence(folder)).network["downlink"]
    lost = sum(recorded_way.lost.values()) or "none"
    assert "as the emulator counted" not in Page([read_evidence(folder)]).html()
    way = netem.downlink
    more = msgspec.structs.replace(way, received=way.received + 50, dropped=way.dropped | {"trace": 2})
    counts = msgspec.structs.replace(summary.counts, netem=msgspec.structs.replace(netem, downlink=more))
    write_summary(msgspec.structs.replace(summary, counts=counts), folder)
    total = recorded_way.messages + 50
    html = Page([read_evidence(folder)]).html()
    all_lost = sum(more.dropped.values())
    said = f"{all_lost} of {total} as the emulator counted from its start to its end; of those recorded {lost} of "
    assert f"<td>{said}" in html


def test_names_cannot_break_the_page(tmp_path):
    path = tmp_path / "x.mcap"
    name = "</script><b>x"
    info = RunInfo(
        scenario={"name": name}, robot=name, session=1, seed=0, versions={"v": name}, operator=name
    )
    RunFile(path, info).close()
    assert "<b>x" not in Page([read_evidence(path)]).html()


def test_two_runs_stand_side_by_side_with_what_differs(folder, tmp_path):
    other = tmp_path / "other.mcap"
    simulate("point-obstacle", network="constant:150", record_to=other, time_limit=3.0, seed=4)
    html = Page([read_evidence(folder), read_evidence(other)]).html()
    assert len(html) < 1e6
    assert html.count('class="turning"') == 2
    assert re.search(r"<td>network.uplink</td><td>5g-urban</td><td>constant:150</td>", html)
    assert re.search(r"<td>seed</td><td>0</td><td>4</td>", html)


def test_the_command_writes_it_into_the_folder_and_says_so(folder, capsys):
    assert run(["report", str(folder)]) == 0
    assert (folder / "report.html").is_file()
    assert str(folder / "report.html") in capsys.readouterr().out


def test_json_is_the_same_for_the_same_run_wherever_it_lies(folder, tmp_path, capsys):
    again = tmp_path / "again"
    again.mkdir()
    result = simulate("point-obstacle", network="5g-urban", record_to=again / "run.mcap", time_limit=3.0)
    write_summary(result.summary, again)
    said = []
    for each in (folder, again):
        assert run(["report", "--json", str(each)]) == 0
        said.append(capsys.readouterr().out)
    assert said[0] == said[1]
    found = msgspec.json.decode(said[0])
    assert found["schema"] == "farhand-report-2"
    assert found["runs"][0]["ticks"] == result.summary.ticks
    assert not (folder / "report.html").exists()


def test_a_line_is_broken_where_something_is_missing_and_nowhere_else():
    t = np.arange(0.0, 3600.0, 0.1)
    values = np.sin(t)
    whole = drawn(Chart("m", [Line("x", "line0", t, values, gap=0.25)]), (0.0, 3600.0), (-1.0, 1.0))
    missing = np.delete(np.arange(len(t)), slice(18000, 18010))
    broken = drawn(
        Chart("m", [Line("x", "line0", t[missing], values[missing], 0.25)]), (0.0, 3600.0), (-1.0, 1.0)
    )
    begins = [re.search(r'class="line0" d="([^"]*)"', each).group(1).count("M") for each in (whole, broken)]
    assert begins == [1, 2]


def test_of_two_runs_each_word_of_the_guard_names_its_run(folder):
    one = read_evidence(folder)
    assert ">guard: " in Page([one]).html()
    both = Page([one, one]).html()
    assert both.count(f">guard of {one.name}: ") == 2
    assert ">guard: " not in both
