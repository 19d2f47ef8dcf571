"""Tables: what pandas reads is what was sent."""

import csv

import pandas as pd
import pytest

from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.exports.export import run_export
from farhand.exports.tables import TICKS, states, tables
from tests.farhand import made_run
from tests.farhand.made_run import (
    GUARDED,
    INTERVENING,
    REFUSED,
    START_NS,
    STOPPED,
    TICK_NS,
    make_run,
)

READ = {"csv": pd.read_csv, "parquet": pd.read_parquet}
RENAMED = {"desired": "asked", "desired_angular": "asked_angular", "angular": "filtered_angular", "position": "tool",
           "orientation": "tool_q", "predicted_orientation": "predicted_q", "inflation": "margin"}  # fmt: skip
STATE_RENAMED = {"t_sample_ns": "sampled_ns", "position": "tool", "orientation": "tool_q",
                 "angular_velocity": "angular", "applied_for_ns": "applied_for", "joints": "joint_0"}  # fmt: skip
NEVER_RECORDED = {"limit", "recording"}
ENVELOPE = {"schema", "source", "t_sent_ns", "echo", "check", "session", "seq", "waiting", "lease_end"}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("made") / "made.mcap"
    return path, make_run(path)


@pytest.mark.parametrize("form", ["csv", "parquet"])
def test_pandas_reads_what_was_sent(run, form, tmp_path):
    path, made = run
    out = tmp_path / "out"
    assert run_export([path], form, out) == 0
    ticks, states_, messages, happenings, runs = (
        READ[form](out / f"{name}.{form}") for name in ("ticks", "states", "messages", "happenings", "runs")
    )
    assert list(ticks.tick) == list(range(made_run.TICKS))
    assert ticks.time.to_numpy() == pytest.approx([i * TICK_NS * 1e-9 for i in range(made_run.TICKS)])
    for i, axis in enumerate("xyz"):
        assert list(ticks[f"asked_{axis}"]) == [each.desired[i] for each in made.reports]
        assert list(ticks[f"filtered_{axis}"]) == [each.filtered[i] for each in made.reports]
        assert list(states_[f"tool_{axis}"]) == [each.position[i] for each in made.states]
    assert pd.isna(ticks.tool_x[0])  # nothing had arrived: nobody knew
    assert pd.isna(ticks.clearance[0])
    assert list(ticks.margin) == [each.inflation for each in made.reports]
    assert list(ticks.index[ticks.intervening]) == list(INTERVENING)
    assert list(states_.joint_4) == [each.joints[4] for each in made.states]
    assert list(states_.arrived_ns - START_NS)[:2] == [19_000_000, 39_000_000]
    assert list(messages.achieved.isna()) == [each.achieved_ns < 0 for each in made.fates]
    assert set(messages.fate) == {"loss", "delivered"}
    assert set(happenings.kind) == {"filter", "stop", "guard", "refused"}
    stop = happenings[happenings.kind == "stop"].iloc[-1]
    assert (stop.began, stop.ended) == pytest.approx((STOPPED[0] * 0.1, STOPPED[-1] * 0.1))
    guard = happenings[happenings.kind == "guard"].iloc[0]
    assert (guard.began, guard.ended) == pytest.approx((GUARDED[0] * 0.1, GUARDED[-1] * 0.1))
    refused = happenings[happenings.kind == "refused"].iloc[0]
    assert refused.began == pytest.approx(REFUSED * 0.1, abs=0.1)
    assert (runs.scenario[0], runs.ticks[0]) == ("made", made_run.TICKS)


def test_every_column_is_described_and_nothing_of_a_message_is_forgotten(run, tmp_path):
    out = tmp_path / "out"
    run_export([run[0]], "csv", out)
    with (out / "columns.csv").open() as file:
        described = [
            (row["table"], row["column"], row["unit"], row["meaning"]) for row in csv.DictReader(file)
        ]
    for table, columns in tables(6).items():
        with (out / f"{table}.csv").open() as file:
            header = next(csv.reader(file))
        assert header == [each.name for each in columns] == [row[1] for row in described if row[0] == table]
    assert all(meaning for *_, meaning in described)
    for kind, columns, renamed in ((ControlReport, TICKS, RENAMED), (RobotState, states(6), STATE_RENAMED)):
        names = {each.name for each in columns}
        for name in set(kind.__struct_fields__) - ENVELOPE - NEVER_RECORDED:
            shown = renamed.get(name, name)
            assert any(
                each == shown or each.startswith(f"{shown}_") or each.startswith(shown) for each in names
            ), name
