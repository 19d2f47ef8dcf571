"""The folder of a run: where it is, what lies in it, and the summary made of it."""

import json
from pathlib import Path
from typing import Any

import msgspec
import tomli_w

from farhand.common.errors import InputError
from farhand.common.timing.clock import local_timestamp
from farhand.runs.results import OperatorResult
from farhand.runs.scenario import Scenario, scenario_to_table
from farhand.runs.summary import RunSummary, Tally, summarise

SCENARIO, OPERATOR, NETEM, ROBOT = "scenario.toml", "operator.json", "netem.json", "robot.json"
RECORDING = "run.mcap"


def make_run_folder(out: Path | None, name: str) -> Path:
    """The folder for a run's files, made if need be; raises InputError where that cannot be."""
    folder = out if out is not None else Path("runs") / f"{local_timestamp()}-{name}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror}") from None
    for stale in (OPERATOR, NETEM, ROBOT, RECORDING, "summary.json"):
        (folder / stale).unlink(missing_ok=True)
    return folder


def write_scenario(scenario: Scenario, folder: Path) -> Path:
    """The scenario with all options applied, as TOML: what the programs load and what can be run again."""
    path = folder / SCENARIO
    path.write_text(tomli_w.dumps(scenario_to_table(scenario)), encoding="utf-8")
    return path


def read_json(path: Path) -> dict[str, Any]:
    """A JSON file; empty when a program died before it could write one."""
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found


def read_operator_result(folder: Path) -> OperatorResult | None:
    """What the operator left behind; None when it died before."""
    try:
        return msgspec.json.decode((folder / OPERATOR).read_bytes(), type=OperatorResult)
    except (OSError, msgspec.MsgspecError):
        return None


def summarise_folder(
    folder: Path, scenario: Scenario, *, seed: int, uplink: str, downlink: str, why: str = ""
) -> RunSummary:
    """The summary of a run of the three programs from the files that they left."""
    operator = read_operator_result(folder)
    robot = read_json(folder / ROBOT)
    tally = Tally()
    finished, duration, solver = False, 0.0, str(scenario.controller.solver)
    rtt: tuple[float | None, float | None] = (None, None)
    if operator is not None:
        tally.ticks, tally.interventions = operator.ticks, operator.interventions
        tally.infeasible, tally.last = operator.infeasible, operator.last_report
        finished, duration, solver = operator.finished, operator.duration, operator.solver
        rtt = (operator.rtt_mean, operator.rtt_std)
        if not finished and not why:
            why = _why(operator, len(scenario.targets))
    else:
        why = why or "the operator's program left no result"
    if not robot:
        why = why or "the robot's program left no result"
    return summarise(
        scenario,
        seed=seed,
        uplink=uplink,
        downlink=downlink,
        tally=tally,
        robot=robot,
        finished=finished,
        duration=duration,
        rtt=rtt,
        solver=solver,
        real_time=True,
        why=why,
    )


def _why(operator: OperatorResult, count: int) -> str:
    last = operator.last_report
    reached = last.target_index if last is not None else 0
    reason = last.stop_reason if last is not None else ""
    standing = "" if reason or last is None or last.binding == "" else f"; held back by {last.binding!r}"
    return f"{reached} of {count} targets reached{standing}" + (f"; at the end: {reason}" if reason else "")
