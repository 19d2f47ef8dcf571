"""Recording a path by echo over real Zenoh, and the `farhand trace` commands around it."""

import json
import socket
import threading

import numpy as np
import pytest
from typer.testing import CliRunner

from farhand.commands.emulation.traces import trace_app
from farhand.common.errors import InputError, TraceError
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.netem.models.profiles import load_model
from farhand.netem.recordings.record import PROBE_KEY, RecordSettings, Reflector, record
from farhand.netem.recordings.trace import load_trace
from farhand.netem.recordings.write import write_trace


def free_endpoint():
    for port in range(21_000, 21_400):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return f"tcp/127.0.0.1:{port}"
    raise AssertionError("no free port")


@pytest.mark.realtime
def test_echoes_make_a_trace_and_unanswered_probes_are_lost(tmp_path):
    endpoint = free_endpoint()
    reflector = Reflector(listen=[endpoint])
    reflected = threading.Event()
    clock = SystemClock()

    def progress(sent, received):
        # The sender waits here, on a busy machine too, until the echoes that the test counts on are under way.
        deadline_ns = clock.now_ns() + to_ns(10)
        while sent > 50 and reflector.reflected < 45 and clock.now_ns() < deadline_ns:
            reflected.wait(0.01)
        if sent > 50:
            reflected.set()
            reflector.close()

    try:
        settings = RecordSettings(connect=[endpoint], rate_hz=50, size=200, duration=1.5, wait=1.0)
        trace = record(settings, clock, on_progress=progress)
    finally:
        if not reflected.is_set():
            reflector.close()
    lost = np.isnan(trace.recorded)
    assert len(lost) == 75
    assert not lost[:40].any()
    assert lost[55:].all()
    assert trace.kind == "round-trip"
    assert (np.diff(trace.times) > 0).all()
    write_trace(trace, tmp_path / "t.csv")
    found = load_trace(tmp_path / "t.csv")
    np.testing.assert_allclose(found.recorded, trace.recorded, rtol=1e-8)
    assert "50 messages a second of 200 bytes" in found.provenance


@pytest.mark.realtime
def test_without_a_reflector_it_says_so():
    endpoint = free_endpoint()
    settings = RecordSettings(connect=[endpoint], duration=0.1, connect_timeout=0.3)
    with pytest.raises(TraceError, match="no reflector at"):
        record(settings, SystemClock())


@pytest.mark.parametrize(
    "options", [{"rate_hz": 0}, {"size": 3}, {"duration": float("nan")}, {"wait": -1}, {"connect": ()}]
)
def test_bad_settings(options):
    with pytest.raises(InputError):
        RecordSettings(**({"connect": ("tcp/127.0.0.1:1",)} | options))


def invoke(*words):
    return CliRunner().invoke(trace_app, [str(word) for word in words])


@pytest.fixture
def slots(tmp_path):
    rng = np.random.default_rng(1)
    path = tmp_path / "made_20ms_slots.txt"
    path.write_text("\n".join(f"{value:.3f}" for value in 10 + rng.gamma(3, 1, 2000)) + "\n")
    return path


def test_show_prints_and_draws(slots, tmp_path):
    figure = tmp_path / "figure.png"
    result = invoke("show", slots, "--figure", figure)
    assert result.exit_code == 0
    assert "2000 samples, 40.0 s, 0 lost" in result.output
    assert figure.read_bytes().startswith(b"\x89PNG")
    summary = json.loads(invoke("show", slots, "--json").output)
    assert summary["p50"] == pytest.approx(0.0127, abs=0.0003)
    assert abs(summary["autocorrelation"]["1"]) < 0.1


def test_show_and_fit_say_how_they_read_the_file(tmp_path):
    path = tmp_path / "irregular.csv"
    instants = [burst * 0.1 + k * 0.005 for burst in range(60) for k in range(5)]
    path.write_text("time,rtt_ms\n" + "".join(f"{t:.3f},{20 + k % 3}\n" for k, t in enumerate(instants)))
    for command in ("show", "fit"):
        output = " ".join(invoke(command, path).output.split())
        for said in (
            "format: csv (by its content)",
            "unit: ms (the column's name)",
            "kind: round-trip (the column's name)",
            "times: s (assumed)",
            "lost: 0 seen, 0 inferred",
            "no loss is inferred from them",
        ):
            assert said in output, said
    assert "0.00 % single losses" in invoke("fit", path).output
    reading = json.loads(invoke("show", path, "--json").output)["reading"]
    assert (reading["lost_seen"], reading["lost_inferred"]) == (0, 0)


def test_fit_writes_a_network(slots, tmp_path):
    result = invoke("fit", slots, "--out", tmp_path / "model.toml")
    assert result.exit_code == 0
    assert "recorded" in result.output
    assert load_model(tmp_path / "model.toml").model.floor > 0.005


def test_convert(slots, tmp_path):
    assert invoke("convert", slots, tmp_path / "a.csv", "--to-unit", "us").exit_code == 0
    np.testing.assert_allclose(load_trace(tmp_path / "a.csv").recorded, load_trace(slots).recorded)
    bad = invoke("convert", slots, tmp_path / "b", "--to", "pcap")
    assert isinstance(bad.exception, TraceError)


def test_the_probe_key_is_not_a_robots():
    assert PROBE_KEY.startswith("farhand/trace/")
