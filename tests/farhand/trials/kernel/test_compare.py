"""What is made of probes and drives: numbers of packets, and the rows of the comparison."""

import math

import numpy as np
import pytest

from farhand.trials.kernel import compare, user_mode_linux
from farhand.trials.kernel.compare import HEADINGS, row
from farhand.trials.kernel.drive import Drive
from farhand.trials.kernel.probe import PacketsSeen

NAN = float("nan")


def test_losses_bursts_and_overtaking_are_counted():
    seen = PacketsSeen(
        np.array([NAN, 0.01, NAN, NAN, 0.03, 0.02, 0.02, NAN]), (1, 5, 4, 6), copies=0, corrupted=0
    )
    found = seen.summary()
    assert found["lost"] == 0.5
    assert found["burst"] == pytest.approx(4 / 3)
    assert found["overtaken"] == 0.25
    assert found["mean"] == pytest.approx(0.02)


def test_nothing_that_came_is_no_number_and_no_error():
    found = PacketsSeen(np.array([NAN, NAN]), (), copies=0, corrupted=0).summary()
    assert math.isnan(found["p99"])
    assert (found["lost"], found["burst"], found["overtaken"]) == (1.0, 2.0, 0.0)


DRIVE = Drive(
    spec="constant:20 loss:5%",
    backend="tc",
    packets={"mean": 0.0201, "std": 0.001, "p50": 0.02, "p99": 0.03, "lost": 0.05, "burst": 1.1},
    drawn=None,
    achieved=None,
    lost=0.048,
    rtt={"mean": 0.0719, "std": 0.0629, "p50": 0.0522, "p99": NAN},
    clearance=0.009,
    duration=35.2,
    refused=3,
    stops=0,
    safe=False,
    finished=False,
    why="",
)


def test_a_row_says_what_was_measured_and_what_was_not():
    found = dict(zip(HEADINGS, row(DRIVE), strict=True))
    assert found["one way (ms)"] == "packets 20.1 ± 1.0, p99 30.0"
    assert found["lost"] == "4.8%"
    assert found["round trip (ms): mean ± sd"] == "71.9 ± 62.9"
    assert found["p99"] == "-"
    assert found["least clearance (mm)"] == "9.0 NOT SAFE"
    assert found["time (s)"] == "35.2, not finished"


def test_where_it_cannot_run_it_says_why_in_one_line(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(compare, "why_no_kernel", lambda: "needs root for network namespaces")
    monkeypatch.setattr("sys.argv", ["compare"])
    assert compare.main() == 2
    assert capsys.readouterr().err == "compare: needs root for network namespaces\n"
    monkeypatch.setattr(user_mode_linux, "why_not", lambda: "needs root")
    monkeypatch.setattr("sys.argv", ["user_mode_linux", str(tmp_path), "true"])
    assert user_mode_linux.main() == 2
    assert capsys.readouterr().err == "user-mode Linux: needs root\n"


@pytest.mark.parametrize("network", ["gausian:50,20", "trace:not-there.csv,period=10"])
def test_a_network_that_cannot_be_read_is_refused_before_anything_is_driven(monkeypatch, capsys, network):
    monkeypatch.setattr(compare, "why_no_kernel", lambda: "")
    monkeypatch.setattr(compare, "drive", lambda *_, **__: pytest.fail("driven"))
    monkeypatch.setattr("sys.argv", ["compare", "--network", network])
    assert compare.main() == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
