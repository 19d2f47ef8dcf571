"""The page says what is so: its access control is one of Zenoh and refuses what it says; RViz has our topics."""

import re
import threading
from pathlib import Path

import pytest
import zenoh

from farhand.bridges.ros2 import RVIZ
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session, zenoh_config

PAGE = (Path(__file__).parents[4] / "docs" / "ros2.md").read_text(encoding="utf-8")


@pytest.mark.realtime
def test_the_access_control_of_the_page_lets_nobody_drive_and_everybody_watch():
    (port,) = free_ports(1)
    rules = re.search(r"```json5\naccess_control: (.*?)\n```", PAGE, re.DOTALL)[1].replace("eth0", "lo")
    config = zenoh_config(listen=[f"tcp/127.0.0.1:{port}"], mode="router")
    config.insert_json5("access_control", rules)
    heard, allowed = [], threading.Event()
    with zenoh.open(config), open_session([f"tcp/127.0.0.1:{port}"], mode="client") as writer, \
            open_session([f"tcp/127.0.0.1:{port}"], mode="client") as reader:  # fmt: skip

        def take(sample):
            heard.append(str(sample.key_expr))
            if "joint_states" in heard[-1]:
                allowed.set()

        reader.declare_subscriber("0/**", take)
        for _ in range(200):
            writer.put("0/farhand/ur5/delta_twist_cmds/type/hash", b"")
            writer.put("0/joy/type/hash", b"")
            writer.put("0/farhand/joint_states/type/hash", b"")
            if allowed.wait(0.1):
                break
        assert allowed.is_set()
        assert not [key for key in heard if "joint_states" not in key]


def test_the_file_for_rviz_shows_what_is_told():
    text = RVIZ.read_text(encoding="utf-8")
    for topic in ("/farhand/robot_description", "/farhand/ur5/markers"):
        assert f"Value: {topic}" in text
    assert "Fixed Frame: base" in text
    assert "\t" not in text
