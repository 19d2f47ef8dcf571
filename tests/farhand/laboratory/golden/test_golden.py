"""The runs in runs.toml give what they gave; and the comparison notices what it must."""

import msgspec
import pytest

from tests.farhand.laboratory.golden import golden
from tests.farhand.laboratory.golden.__main__ import renew

KEPT = golden.read_golden()
OTHERS = golden.differences(KEPT.made_with, golden.made_with())


@pytest.mark.parametrize("kept", KEPT.run, ids=lambda run: run.name)
def test_a_run_gives_what_it_gave(kept):
    now = golden.run_golden(kept)
    assert golden.changed_facts(kept, now) == []
    if not OTHERS:
        assert golden.changed_bytes(kept, now) == []


@pytest.mark.skipif(bool(OTHERS), reason=f"facts were compared, bytes were not: {'; '.join(OTHERS)}")
def test_bytes_were_compared_here():
    assert KEPT.made_with == golden.made_with()


def test_the_runs_are_a_dozen_and_tell_something():
    assert len(KEPT.run) >= 12
    assert len({run.name for run in KEPT.run}) == len(KEPT.run)
    assert len({run.messages for run in KEPT.run}) == len(KEPT.run)
    assert {run.scenario for run in KEPT.run} == {"point-obstacle", "box-obstacle", "ur5-obstacle"}
    assert {run.safe for run in KEPT.run} == {run.finished for run in KEPT.run} == {True, False}
    assert all(len(run.messages) == len(run.decisions) == 64 for run in KEPT.run)


def changed(**values):
    return msgspec.structs.replace(KEPT.run[0], **values)


@pytest.mark.parametrize("digest", ["messages", "decisions"])
def test_another_byte_is_noticed(digest):
    assert golden.changed_bytes(KEPT.run[0], changed(**{digest: "0" * 64})) == [
        f"{digest}: {getattr(KEPT.run[0], digest)[:12]} -> 000000000000"
    ]
    assert golden.changed_facts(KEPT.run[0], changed(**{digest: "0" * 64})) == []


@pytest.mark.parametrize(
    ("fact", "near", "far"),
    [
        ("clearance", 0.9 * golden.TOLERANCE, 1.2 * golden.TOLERANCE),
        ("duration", golden.TICK, 1.1 * golden.TICK),
        ("ticks", 1, 2),
        ("safe", False, -1),
        ("finished", False, -1),
    ],
)
def test_another_fact_is_noticed(fact, near, far):
    was = getattr(KEPT.run[0], fact)
    assert golden.changed_facts(KEPT.run[0], changed(**{fact: was + near})) == []
    (line,) = golden.changed_facts(KEPT.run[0], changed(**{fact: was + far}))
    assert line.startswith(fact)


def test_what_is_unknown_or_another_is_not_the_same():
    here = golden.made_with()
    assert set(here) > {
        "numpy",
        "numba",
        "casadi",
        "pybullet",
        "pin",
        "python",
        "processor",
        "linear_algebra",
    }
    assert golden.differences(here, here) == ([] if here["linear_algebra"] != "unknown" else ["x"])
    assert golden.differences(here, here | {"numpy": "99.0"}) == [f"numpy {here['numpy']}, here 99.0"]
    unknown = here | {"linear_algebra": "unknown"}
    assert golden.differences(unknown, unknown) == ["linear_algebra unknown, here unknown"]


def test_renewing_says_what_changed_and_keeps_it(tmp_path, capsys):
    path = tmp_path / "runs.toml"
    short = changed(time_limit=1.0, seed=2)
    golden.write_golden(golden.GoldenFile({"numpy": "1.0"}, [short]), path)
    assert renew(path) == 1
    said = capsys.readouterr().out
    assert "made with numpy 1.0, here" in said
    assert f"messages: {short.messages[:12]} -> " in said
    assert "finished: true -> false" in said
    assert "1 of 1 runs changed" in said
    assert golden.read_golden(path).made_with == golden.made_with()
    assert renew(path) == 0
    assert capsys.readouterr().out == "0 of 1 runs changed; runs.toml says what they give now\n"
