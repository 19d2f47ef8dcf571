"""Runs whose outcome is kept in runs.toml: to the byte where it was made, within a tolerance elsewhere.

Where the same bytes can be expected was tried, not guessed. All runs gave the same bytes with numba compiling for
another processor, with numba not compiling at all, and without numpy's vector instructions. With another kernel of
the linear algebra library (OpenBLAS chooses one by the processor) the bytes of some runs or of all differed, and
every clearance by less than 1e-14 m. So bytes are compared where all of `made_with` is the same, the kernel included;
else the facts are, within TOLERANCE and one tick.

What no tolerance covers: a numpy that draws other numbers from the same seed (it may change that with a release) is
another network, and a solver or physics engine with another algorithm is another run. Then look at what changed,
and renew the values on purpose: `make golden`.
"""

import ctypes
import hashlib
import importlib.metadata
import json
import platform
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import tomli_w

from farhand.laboratory.simulation import simulate
from farhand.runs.scenario import load_scenario, replace_setting

VALUES = Path(__file__).with_name("runs.toml")
TOLERANCE = 1e-5
"""Of a clearance (m), where bytes may differ."""
TICK = 0.1
"""Of a duration (s): a control tick."""
LIBRARIES = ("numpy", "numba", "casadi", "daqp", "pybullet", "pin", "msgspec")
HEAD = """\
# What some runs in virtual time gave. Not to be edited: `make golden` renews it and says what changed.
# messages: SHA-256 over all that left or reached the operator, with its instant; decisions: over what it decided.
# clearance: the least (m); duration (s). When bytes must be the same, and when only the facts: golden.py.

"""


class Golden(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """What is run, and what it gave.

    Attributes:
        scenario, uplink, downlink, seed, time_limit: the run; times in s.
        settings: in place of the scenario's, by dotted key.
        messages, decisions: digests.
        clearance, duration, ticks, safe, finished: facts.
    """

    scenario: str
    uplink: str
    downlink: str
    seed: int
    time_limit: float
    messages: str
    decisions: str
    clearance: float
    duration: float
    ticks: int
    safe: bool
    finished: bool
    settings: dict[str, str | bool] = {}

    @property
    def name(self) -> str:
        """One line that tells it from all others."""
        changed = "".join(f" {key}={value}" for key, value in self.settings.items())
        return f"{self.scenario}{changed} over {self.uplink} / {self.downlink}, seed {self.seed}"


class GoldenFile(msgspec.Struct, forbid_unknown_fields=True):
    """runs.toml: what the values were made with, and the runs."""

    made_with: dict[str, str]
    run: list[Golden]


def read_golden(path: Path = VALUES) -> GoldenFile:
    """The values that are kept."""
    return msgspec.toml.decode(path.read_bytes(), type=GoldenFile)


def write_golden(values: GoldenFile, path: Path = VALUES) -> None:
    """Keep other values."""
    path.write_text(HEAD + tomli_w.dumps(msgspec.to_builtins(values)), encoding="utf-8")


def run_golden(given: Golden) -> Golden:
    """The same run, with what it gives now."""
    scenario = load_scenario(given.scenario)
    for key, value in given.settings.items():
        scenario = replace_setting(scenario, key, value)
    result = simulate(
        scenario,
        uplink=given.uplink,
        downlink=given.downlink,
        seed=given.seed,
        time_limit=given.time_limit,
        digest=True,
        keep_reports=True,
    )
    decisions = hashlib.sha256()
    for report in result.reports:
        decided = (
            report.filtered,
            report.predicted,
            report.sigma,
            report.inflation,
            report.status,
            report.mode,
        )
        decisions.update(repr(decided).encode())
    summary = result.summary
    return msgspec.structs.replace(
        given,
        messages=result.digest,
        decisions=decisions.hexdigest(),
        clearance=round(float(summary.min_clearance), 6),
        duration=round(summary.duration, 3),
        ticks=summary.ticks,
        safe=summary.safe,
        finished=summary.finished,
    )


def changed_facts(kept: Golden, now: Golden) -> list[str]:
    """Facts that differ by more than another machine may make them differ, one line each."""
    near = {"clearance": TOLERANCE, "duration": TICK + 1e-9, "ticks": 1, "safe": 0, "finished": 0}
    pairs = [(fact, getattr(kept, fact), getattr(now, fact), limit) for fact, limit in near.items()]
    return [f"{fact}: {was} -> {found}" for fact, was, found, limit in pairs if abs(found - was) > limit]


def changed_bytes(kept: Golden, now: Golden) -> list[str]:
    """Every value that is not exactly what it was, one line each."""
    values = ("messages", "decisions", "clearance", "duration", "ticks", "safe", "finished")
    pairs = [(value, getattr(kept, value), getattr(now, value)) for value in values]
    return [f"{value}: {_short(was)} -> {_short(found)}" for value, was, found in pairs if was != found]


def made_with() -> dict[str, str]:
    """Everything here that may decide the last bit."""
    found = {name: importlib.metadata.version(name) for name in LIBRARIES}
    found["python"] = "{}.{}".format(*sys.version_info)
    found["processor"] = platform.machine()
    found["libc"] = " ".join(platform.libc_ver())
    found["linear_algebra"] = next(_kernels(), "unknown")
    return found


def differences(kept: dict[str, str], here: dict[str, str]) -> list[str]:
    """What of `made_with` is another, one line each; something unknown is never the same."""
    names = sorted(kept.keys() | here.keys())
    pairs = [(name, kept.get(name, "nothing"), here.get(name, "nothing")) for name in names]
    return [f"{name} {was}, here {is_}" for name, was, is_ in pairs if was != is_ or is_ == "unknown"]


def _kernels() -> Iterator[str]:
    """The kernel that numpy's own OpenBLAS has chosen for this processor."""
    for path in Path(np.__file__).parent.parent.glob("numpy.libs/*openblas*"):
        ask = getattr(ctypes.CDLL(str(path)), "scipy_openblas_get_corename64_", None)
        if ask is not None:
            ask.restype = ctypes.c_char_p
            yield ask().decode()


def _short(value: Any) -> str:
    return value[:12] if isinstance(value, str) else json.dumps(value)
