"""The demo for a browser: its address is said once it is answered there."""

import urllib.request

import pytest

from farhand.testing import Program, short_task

pytestmark = pytest.mark.realtime


def test_who_follows_the_address_at_once_gets_the_page(tmp_path):
    words = "--scenario", short_task(tmp_path), "--steer", "browser", "--camera", "off", "--network", "none"
    with Program("demo", *words, "--out", tmp_path / "run", "--json") as demo:
        address = demo.wait_for("drive at http").split()[-1]
        with urllib.request.urlopen(address, timeout=5) as answer:
            assert answer.status == 200
        demo.interrupt()
