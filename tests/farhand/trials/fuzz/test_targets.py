"""Every edge takes its kept inputs, those that once broke a promise and some new ones, and keeps its promise."""

import base64
import struct
import zlib
from pathlib import Path

import msgspec
import numpy as np
import pytest

from farhand.cli import run as run_cli
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.robot_side.ur.rtde_codec import INPUTS, OUTPUTS, URCONTROL, VERSION, pack
from farhand.trials.fuzz import campaign
from farhand.trials.fuzz.mutation import mutated
from farhand.trials.fuzz.registry import NAMES, target_called
from farhand.trials.fuzz.target import FindingError
from farhand.trials.fuzz.targets.files import recording
from farhand.trials.fuzz.targets.wire import robot_intake

KEPT = Path(__file__).parent / "corpus"
SLOW = {"operator-tick": 25, "recording": 60, "console-page": 100, "ur-script": 100, "live-control": 150}
NEW = 250
"""New inputs of a target that is not slow."""


def kept(name):
    """Inputs that a campaign found to reach something new."""
    path = KEPT / f"{name}.txt"
    return [base64.b64decode(line) for line in path.read_text().split()] if path.exists() else []


def conversation(*last):
    version = pack(VERSION, b"\1") + pack(URCONTROL, b"\0\0\0\5" * 4)
    return version + pack(OUTPUTS, b"\1DOUBLE,VECTOR6D,INT32") + b"".join(last)


REGRESSIONS = {
    "scenario": [b'name="x"\nstart=[0,0,0]\ntargets=[[1,0,0]]\n[margin."a\\nb"]\nx=1'],
    "scene-words": [msgspec.msgpack.encode({"deed": "set", "\nfarhand: all is well": 1})],
    "timeline": [b'"a\\nb"=1', b'[[at]]\ntime=1\ndo="set"\n"x\\ny"=1'],
    "sweep": [b'"a\\nb"=1\nscenario="random-tasks"\n[grid]', b'scenario="random-tasks"\n[grid]\n"a\\nb"=[]'],
    "console-page": [b"\0" + msgspec.msgpack.encode({"kind": "steer", "\nfarhand: all is well": 1})],
    "recording": [recording.seeds()[1].replace(b"farhand/r/state", b"farhand/\x95/state")],
    "requests": [which + b'{"since":3,"\xff":1}' for which in (b"\0", b"\1")],
    "ur-rtde-server": [pack(OUTPUTS, struct.pack(">d", float("nan")) + b"timestamp")],
    "ur-rtde-client": [conversation(pack(INPUTS))],
}
"""Each of them broke its target's promise once."""


@pytest.mark.parametrize("name", NAMES)
def test_an_edge_keeps_its_promise(name):
    target = target_called(name)
    take, inputs = target.start(), [*target.seeds(), *kept(name), *REGRESSIONS.get(name, ())]
    for data in inputs:
        take(data)
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    for _ in range(SLOW.get(name, NEW)):
        take(mutated(target, inputs[int(rng.integers(len(inputs)))], rng))


def test_a_robot_that_obeys_what_is_stale_is_found(monkeypatch):
    monkeypatch.setattr(Watchdog, "_staleness", lambda *_: "")
    take = target_called("robot-intake").start()
    stale = robot_intake.command(6, age_ns=2_000_000_000, velocity=(0.3, 0.0, 0.0))
    with pytest.raises(FindingError, match="stale"):
        take(stale)


def test_a_robot_that_obeys_a_foreign_session_is_found(monkeypatch):
    monkeypatch.setattr(
        Watchdog, "_judge_outsider", lambda self, command, now_ns: self._judge_holder(command, "", now_ns)
    )
    take = target_called("robot-intake").start()
    with pytest.raises(FindingError, match="foreign session"):
        take(robot_intake.command(6, session=robot_intake.OTHER, velocity=(0.3, 0.0, 0.0)))


def test_what_libfuzzer_says_is_read():
    said = (
        "#512\tNEW    cov: 88 ft: 97 corp: 7/120b lim: 4 exec/s: 0 rss: 91Mb L: 9/40 MS: 1 Custom-\n"
        "#600\tDONE   cov: 89 ft: 99 corp: 9/140b lim: 4 exec/s: 300 rss: 92Mb\n"
        "stat::number_of_executed_units: 600\n"
    )
    assert campaign.read_log("mesh", said) == campaign.Piece(
        target="mesh", inputs=600, covered=89, corpus=9, memory=92
    )
    found = said.replace("#600", "#599") + (
        " === Uncaught Python exception: ===\nIndexError: index out of range\n"
        "artifact_prefix='x/'; Test unit written to x/mesh-crash-1\n"
    )
    piece = campaign.read_log("mesh", found)
    assert (piece.finding, piece.said) == ("mesh-crash-1", "IndexError: index out of range")


def test_a_target_that_there_is_not_is_one_line(capsys):
    assert run_cli(["trial", "fuzz", "--targets", "codec,kitchen"]) == 2
    assert "'kitchen': must be some of codec," in capsys.readouterr().err
