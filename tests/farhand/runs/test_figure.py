"""The figure tells the truth: broken lines, marked stops, no ring that swallows the path, violations that are seen."""

import matplotlib as mpl
import msgspec
import numpy as np
import pytest

mpl.use("Agg")
import matplotlib.pyplot as plt

from farhand.netem.measure.result import DirectionCounts, NetemCounts
from farhand.robot_side.result import RobotResult
from farhand.runs import figure
from farhand.runs.results import RunResults
from farhand.runs.run import Run, choose_network
from farhand.runs.scenario import load_scenario
from farhand.runs.summary import summarise

POINT = load_scenario("point-obstacle")
RUN = Run(scenario=POINT, network=choose_network(POINT))
OBSTACLE = POINT.obstacles[0]
KEEP = OBSTACLE.shape.radius + POINT.robot.radius + POINT.controller.d_min


@pytest.fixture
def axes():
    made, found = plt.subplots()
    yield found
    plt.close(made)


def summary(**robot):
    return summarise(
        RUN,
        RunResults(robot=RobotResult(**({"min_clearance": 0.5, "ticks": 1, "stops": 0} | robot))),
        real_time=False,
    )


def test_the_round_trip_is_not_one_line_through_a_silence(axes):
    series = [(0.1 * k, 0.12, 0.0, 0.0, 1.0) for k in range(1, 60)]
    figure._draw_round_trip(axes, series, [(2.0, 4.0)])
    t, rtt = axes.lines[0].get_data()
    assert np.isnan(rtt[(t > 2.0) & (t < 4.0)]).all()
    assert not np.isnan(rtt[(t < 2.0) | (t > 4.0)]).any()


def test_stops_and_silences_are_marked_in_both(axes):
    made, below = plt.subplots()
    found = summary(min_clearance=0.5, interruptions=[(3.0, "stopped", "why"), (2.0, "hold", "why")])
    figure._mark_interruptions(axes, below, found, [(2.0, 4.0)])
    for each in (axes, below):
        assert len(each.patches) == 1
        assert [line.get_xdata()[0] for line in each.lines] == [3.0]
    assert {text.get_text() for text in below.get_legend().get_texts()} == {"no answer", "stop"}
    plt.close(made)


def test_a_hold_alone_has_no_mark_and_so_no_legend(axes):
    made, below = plt.subplots()
    figure._mark_interruptions(axes, below, summary(interruptions=[(2.0, "hold", "no commands")]), [])
    assert below.get_legend() is None
    plt.close(made)


def test_a_tool_in_front_of_a_limit_is_not_drawn_as_inside():
    x, y, z = OBSTACLE.position
    beside = [(0.0, x + KEEP + 0.1, y, z, 1.0)]
    front = [(0.1, x, y + KEEP + 0.1, z, 0.1)]
    inside = [(0.2, x, y, z + KEEP - 0.05, -0.05)]
    assert figure.passing(POINT, np.array(beside + front + inside), (0, 2)).tolist() == [False, True, False]


def test_the_ring_is_that_of_the_margin_at_the_obstacle_not_of_the_largest():
    series = [(0.0, 0.1, 0.0, 0.6, 1.5), (1.0, 0.1, 0.0, 0.02, 0.03), (2.0, 0.1, 0.0, 0.3, None)]
    assert figure.margin_when_nearest(series) == 0.02
    assert figure.margin_when_nearest([]) == 0.0


def test_a_violation_of_a_millimetre_is_marked_and_named(axes):
    path = np.array([(0.1 * k, 0.01 * k, 0, 0, 1.0 if k != 30 else 0.0089) for k in range(60)])
    found = summary(min_clearance=0.0089, nearest_obstacle="ball")
    figure._draw_clearance(axes, found, path, 0.0)
    assert "1.1 mm too near" in [text.get_text() for text in axes.texts]
    made, plane = plt.subplots()
    figure._draw_path(plane, POINT, found, path, [])
    assert "too near" in [line.get_label() for line in plane.lines]
    plt.close(made)


def test_neither_legend_nor_note_lies_on_a_curve(axes):
    """They stand over the axes, in which every curve is."""
    lost = NetemCounts(uplink=DirectionCounts(dropped={"loss": 2}), downlink=DirectionCounts())
    found = summary()
    found = msgspec.structs.replace(found, counts=msgspec.structs.replace(found.counts, netem=lost))
    path = np.array([(0.1 * k, 0.0, 0.0, 0.0, 0.5) for k in range(20)])
    figure._draw_clearance(axes, found, path, 0.0)
    figure._mark_interruptions(axes, axes, found, [(0.5, 1.0)])
    axes.figure.canvas.draw()
    top = axes.bbox.y1
    assert axes.get_legend().get_window_extent().y0 >= top - 1.0
    (note,) = [text for text in axes.texts if text.get_text().startswith("lost")]
    assert note.get_window_extent().y0 >= top
