"""One run of each communication error keeps the promise; a robot that breaks it is found."""

import msgspec
import pytest

from farhand.cli import run as run_cli
from farhand.common.geometry import STILL, Twist
from farhand.common.link.link import Packet
from farhand.common.messages.base import ZERO, Echo
from farhand.common.messages.codec import encode
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.testing import command
from farhand.trials.errors.errors import ERRORS
from farhand.trials.errors.judge import Judge
from farhand.trials.errors.running import Row, run_one, specs
from farhand.trials.errors.tables import broken, to_markdown

ROBOT, KEY, SECOND_NS = 9, "farhand/r/command", 1_000_000_000
TWO = Twist((0.2, 0.0, 0.0), ZERO)


def one(name):
    return run_one(specs((name,), 1, seed=7)[0])


@pytest.mark.parametrize("name", ERRORS)
def test_nothing_moves_that_no_fresh_lawful_command_explains(name):
    row = one(name)
    assert broken([row]) == []
    assert row.again or row.mode == "estop"
    if name in (
        "corrupt-up",
        "corrupt-down",
        "loss-up",
        "loss-down",
        "delay-up",
        "delay-down",
        "held-up",
        "burst",
    ):
        assert row.standing is not None
        assert row.standing < 2.5
    if name == "forged":
        assert row.unexplained > 0  # the judge sees what messages alone cannot keep out
    text = to_markdown([row])
    assert f"| `{name}` | {ERRORS[name].how}" in text  # by its id it is asked for again
    assert ("†: " in text) == ERRORS[name].insider


@pytest.mark.parametrize(
    ("check", "name"),
    [("_staleness", "held-up"), ("_is_old", "old-commands"), ("_judge_outsider", "foreign")],
)
def test_a_robot_that_breaks_the_promise_is_found(monkeypatch, check, name):
    if check == "_judge_outsider":
        monkeypatch.setattr(Watchdog, check, lambda self, command, now_ns: "")
    else:
        monkeypatch.setattr(Watchdog, check, lambda *_: "" if check == "_staleness" else False)
    assert broken([one(name)])


def sent(seq, age_ns, now_ns, session=ROBOT, **fields):
    message = command(seq, echo=Echo(session, 1, now_ns - age_ns, 0), velocity=TWO.linear, **fields)
    return encode(message), message


@pytest.fixture
def judge():
    return Judge(ROBOT, KEY, SECOND_NS)


def arrives(judge, payload, now_ns, key=KEY):
    judge.taken([Packet(key, payload, now_ns)], now_ns)


def test_the_judge_explains_a_fresh_lawful_plan_until_it_ends(judge):
    now_ns = 5 * SECOND_NS
    payload, message = sent(3, 40_000_000, now_ns, plan=((0.1, 0.0, 0.0),))
    judge.sent(payload, message)
    arrives(judge, payload, now_ns)
    judge.told(TWO, now_ns + 99_000_000)
    judge.told(Twist((0.1, 0.0, 0.0), ZERO), now_ns + 150_000_000)
    judge.told(STILL, now_ns + 900_000_000)
    assert (judge.unexplained, judge.oldest_ns) == (0, 40_000_000)
    judge.told(TWO, now_ns + 150_000_000)
    assert judge.unexplained == 1


@pytest.mark.parametrize(
    "wrong", ["stale", "foreign bytes", "other robot", "old number", "other key", "nothing sent"]
)
def test_the_judge_explains_nothing_else(judge, wrong):
    now_ns = 5 * SECOND_NS
    age_ns = 1_001_000_000 if wrong == "stale" else 0
    payload, message = sent(3, age_ns, now_ns, session=8 if wrong == "other robot" else ROBOT)
    if wrong != "nothing sent":
        judge.sent(payload, message)
    if wrong == "old number":
        newer, what = sent(4, 0, now_ns, session=8)
        judge.sent(newer, what)
        arrives(judge, newer, now_ns)
    arrives(judge, payload[:-1] + b"\0" if wrong == "foreign bytes" else payload, now_ns,
            "farhand/other/command" if wrong == "other key" else KEY)  # fmt: skip
    judge.told(TWO, now_ns)
    assert judge.unexplained == 1
    assert judge.fastest == 0.2


def test_what_does_not_hold_is_said_run_by_run():
    good = Row(key="foreign/0", name="foreign", seed=1, oldest=0.2)
    moved = msgspec.structs.replace(good, unexplained=3, fastest_unexplained=0.5)
    assert broken([good]) == []
    assert "foreign/0: 3 periods at up to 0.50 m/s" in to_markdown([moved])
    assert "1.20 s old" in broken([msgspec.structs.replace(good, oldest=1.2)])[0]
    near = Row(key="forged-guarded/0", name="forged-guarded", seed=1, clearance=0.009)
    assert "9.0 mm" in broken([near])[0]


def test_the_command_prints_its_table_and_goes_on(tmp_path, capsys):
    words = [
        "trial",
        "errors",
        "--errors",
        "loss-up",
        "--workers",
        "1",
        "--out",
        str(tmp_path / "e"),
        "--runs",
    ]
    assert run_cli([*words, "1"]) == 0
    assert "no command arrives (netem) | 1 |" in capsys.readouterr().out
    assert run_cli([*words, "1"]) == 0
    assert "going on: 1 of 1" in capsys.readouterr().out


def test_an_error_that_there_is_not_is_one_line(tmp_path, capsys):
    assert run_cli(["trial", "errors", "--errors", "jealousy", "--out", str(tmp_path)]) == 2
    assert "'jealousy': must be some of corrupt-up," in capsys.readouterr().err
