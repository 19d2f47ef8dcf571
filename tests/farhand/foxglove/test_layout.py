"""The layout that is shipped is the one that the code makes, and shows what there is."""

import json
import re

from farhand.foxglove.layout import CAMERA, PLOTS, SHIPPED, layout_file
from farhand.foxglove.view import FoxgloveView, scalars
from farhand.testing import report


def test_the_file_is_what_the_code_makes():
    assert SHIPPED.read_bytes() == layout_file(), "run scripts/make_foxglove_layout.py"


def test_it_names_only_topics_and_scalars_that_there_are():
    topics = {channel.topic for channel in FoxgloveView(0.01).channels} | {CAMERA}
    text = SHIPPED.read_text()
    assert json.loads(text)["content"]["type"] == "split"
    named = set(re.findall(r'"(/[a-z]+)', text))
    assert named
    assert named <= topics
    labels = {each["label"] for each in json.loads(scalars(report(rtt=0.1, clearance=0.1)))["scalars"]}
    assert {label for _, _, series in PLOTS for label, _ in series} <= labels
