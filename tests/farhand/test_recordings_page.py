"""docs/recordings.md names every topic of a recording, of a bag, and every feature of a dataset, and none besides."""

import json
import re
from pathlib import Path

from farhand.cli import run
from farhand.exports.axes import as_positions
from farhand.exports.episodes import values_of
from farhand.exports.lerobot import CAMERA_KEY
from farhand.exports.rosbag import TOPICS
from farhand.exports.tables import tables
from farhand.foxglove.recorded_topics import RecordedTopics
from farhand.testing import report, state
from tests.farhand.made_run import make_run

PAGE = (Path(__file__).parents[2] / "docs/recordings.md").read_text()


def section(title):
    return re.search(rf"^#+ {title}\n(.*?)(?=^#)", PAGE, re.S | re.M).group(1)


def first_cells(text, pattern):
    cells = [row.split("|")[1] for row in text.splitlines() if row.startswith("|")]
    return {found for cell in cells for found in re.findall(pattern, cell)}


def test_topics_of_a_recording(tmp_path):
    make_run(tmp_path / "made.mcap", ticks=12, camera=True)
    topics = RecordedTopics(tmp_path / "made.mcap")
    assert first_cells(section("What is in the file"), r"`(/[^`]+)`") == {each.topic for each in topics.specs}
    topics.close()


def test_topics_of_a_bag():
    text = section("ROS 2")
    assert first_cells(text, r"`(/[^`]+)`") == set(TOPICS)
    assert set(re.findall(r"`(\w+/msg/\w+)`", text)) == set(TOPICS.values())


def test_features_of_a_dataset():
    zero = (0.0, 0.0, 0.0)
    values = values_of(report(), state(), (zero, zero), (1.0, 0.0, 0.0, 0.0))
    features = {*values, *as_positions(values, 0.1), CAMERA_KEY}
    assert first_cells(section("LeRobot"), r"`([a-z._]+)`") == features


def test_fields_of_the_report_as_json(tmp_path, capsys):
    """Under one `schema` no field goes and none changes its name: who compares runs relies on it."""
    make_run(tmp_path / "made.mcap", ticks=12)
    assert run(["report", str(tmp_path / "made.mcap"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    text = section("As JSON")
    assert f"`{found['schema']}`" in text
    assert first_cells(text, r"`([a-z_]+)`") == set(found["runs"][0])
    assert ", ".join(found["runs"][0]["margin_width"]) == "count, mean, p50, p99, max"
    assert ", ".join(found["runs"][0]["events"][0]) == "kind, begin, end, words, facts"


def test_tables():
    assert all(f"`{name}`" in section("Tables") for name in tables(0))
