"""Words that installed packages bring: they work wherever a word of our own does."""

import json
from dataclasses import dataclass
from typing import ClassVar

import pytest
from typer.testing import CliRunner

from farhand.cli import app
from farhand.common.errors import InputError, SpecError
from farhand.common.link.link import Packet
from farhand.laboratory.simulation import simulate
from farhand.laboratory.virtual_executor import VirtualExecutor
from farhand.netem.action import Action
from farhand.netem.chain import Chain
from farhand.netem.control import handle
from farhand.netem.emulation import Emulation
from farhand.netem.impairments.base import Impairment, LossModel, Scope, Stage, Transit, Word
from farhand.netem.impairments.registry import BUILT_IN, described, kinds, word_called
from farhand.netem.netem_node import NetemNode
from farhand.netem.spec import parse_spec
from farhand.netem.tc.words import kernel_network
from farhand.netem.words.reader import SpecReader
from farhand.runs.scenario import load_scenario

GROUP = "farhand.impairments"
MS = 1_000_000


class Late(Word, frozen=True):
    """Every n-th message is this much later."""

    every: int
    later_ns: int
    name: ClassVar[str] = "late"
    example: ClassVar[str] = "late:3,20"
    description: ClassVar[str] = "every third message comes 20 ms later"
    kind: ClassVar[str] = "late"
    stage: ClassVar[Stage] = Stage.DELAY
    scope: ClassVar[Scope] = Scope.LINK

    @classmethod
    def parse(cls, reader: SpecReader) -> "Late":
        reader.expect(":", "every how many-th")
        every = reader.count("every how many-th")
        return cls(every, reader.duration_ns("how much later, in ms") if reader.take(",") else 20 * MS)

    def text(self) -> str:
        return f"late:{self.every},{self.later_ns // MS}"

    def build(self, context) -> Impairment:
        return _Late(self)


@dataclass
class _Late(Impairment):
    word: Late
    seen: int = 0

    def apply(self, transit: Transit) -> None:
        self.seen += 1
        if self.seen % self.word.every == 0:
            transit.release_ns += self.word.later_ns


class Odd(Word, frozen=True):
    """Loses the first transmission of each message."""

    name: ClassVar[str] = "odd"
    kind: ClassVar[str] = "loss"
    stage: ClassVar[Stage] = Stage.LOSS

    @classmethod
    def parse(cls, reader: SpecReader) -> "Odd":
        return cls()

    def text(self) -> str:
        return "odd"

    def build(self, context) -> Impairment:
        return _Odd()


class _Odd(LossModel):
    def loses(self, transit: Transit, instant_ns: int) -> bool:
        return transit.retransmissions == 0


class Nameless(Word, frozen=True):
    """Lacks its stage."""

    name: ClassVar[str] = "nameless"
    kind: ClassVar[str] = "delay"


@pytest.fixture
def late(brought):
    brought(GROUP, "late", f"{__name__}:Late")
    brought(GROUP, "odd", f"{__name__}:Odd")


def releases(spec: str, count: int = 6) -> list[int]:
    chain = Chain(parse_spec(spec), 1, "uplink")
    found = []
    for number in range(count):
        now_ns = (1 + number) * 100 * MS
        (transit,) = chain.offer(Packet("farhand/a/command", b"12345678", now_ns), now_ns)
        found.append(-1 if transit.cause else (transit.release_ns - now_ns) // MS)
    return found


def test_a_word_from_outside_is_read_and_written(late):
    spec = parse_spec("constant:5 late:3 loss:1% camera[late:2,7]")
    assert str(spec) == "loss:1% constant:5 late:3,20 camera[late:2,7]"
    assert parse_spec(str(spec)) == spec
    assert str(spec.without("late")) == "loss:1% constant:5 camera[late:2,7]"


def test_it_acts_in_the_chain(late):
    assert releases("constant:5 late:3") == [5, 5, 25, 5, 5, 25]
    assert releases("constant:5 late:3 duplicate:0%") == [5, 5, 25, 5, 5, 25]


def test_its_losses_are_repaired_by_ours(late):
    assert releases("odd constant:5", 3) == [-1, -1, -1]
    assert releases("odd constant:5 tcp-like:30", 3) == [35, 35, 35]


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("late", 5, "expected ':' and every how many-th, e.g. late:3,20"),
        ("constant:5 late:0", 17, "every how many-th must be a whole number from 1 on, e.g. late:3,20"),
        ("late:3 late:4", 8, "a second late"),
        ("lte:3", 1, "is 'late' meant?"),
    ],
)
def test_bad_settings_point_at_the_character(late, text, place, words):
    with pytest.raises(SpecError) as found:
        parse_spec(text)
    assert f"at character {place}:" in str(found.value)
    assert words in str(found.value)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("broken", "no_such_module:Late", "package their-package: farhand.impairments: impairment 'broken'"),
        ("nameless", f"{__name__}:Nameless", "Nameless has no 'stage'"),
        ("renamed", f"{__name__}:Late", "calls itself 'late'"),
        ("5g-urban", f"{__name__}:Late", "'5g-urban' is built in"),
    ],
)
def test_one_that_cannot_be_is_one_line_at_its_place(brought, name, value, words):
    brought(GROUP, name, value)
    with pytest.raises(SpecError) as found:
        parse_spec(f"loss:1% {name}:3")
    assert "at character 9:" in str(found.value)
    assert words in str(found.value)
    assert "\n" not in str(found.value)


def test_it_is_listed_and_can_be_removed(late):
    assert ("late:3,20", "every third message comes 20 ms later") in described()
    assert ("odd", "") in described()
    assert kinds() == (
        "outage", "loss", "tcp-like", "duplicate", "recorded", "corrupt",
        "rate", "delay", "late", "reorder", "slot", "limit"
    )  # fmt: skip
    shown = CliRunner().invoke(app, ["networks"])
    assert "late:3,20" in shown.output


def test_a_broken_package_does_not_hide_the_others(brought):
    brought(GROUP, "broken", "no_such_module:Late")
    rows = dict(described())
    assert "cannot be imported" in rows["broken"]
    assert "constant:200" in rows
    assert "delay" in kinds()


def test_in_a_run_of_the_laboratory_and_its_timeline(late, tmp_path):
    scenario = load_scenario("point-obstacle")
    timeline = tmp_path / "timeline.toml"
    timeline.write_text(
        '[[at]]\ntime = 0.5\ndo = "add"\nspec = "late:2,50"\n[[at]]\ntime = 1.5\ndo = "remove"\nname = "late"\n'
    )
    plain = simulate(scenario, uplink="constant:20", downlink="none", time_limit=2.0)
    mine = simulate(scenario, uplink="late:2,50 constant:20", downlink="none", time_limit=2.0)
    changed = simulate(
        scenario, uplink="constant:20", downlink="none", time_limit=2.0, timeline=str(timeline)
    )
    achieved = [run.network.uplink.achieved.mean for run in (plain, changed, mine)]
    assert achieved[0] == pytest.approx(0.02)
    assert achieved[2] == pytest.approx(0.045, abs=0.003)
    assert achieved[0] < achieved[1] < achieved[2]
    assert mine.network.uplink.spec == "constant:20 late:2,50"


def test_on_the_command_line(late):
    done = CliRunner().invoke(
        app,
        ["simulate", "--scenario", "point-obstacle", "--network", "late:3", "--time-limit", "1", "--json"],
    )
    assert '"uplink":"late:3"' in done.output
    refused = CliRunner().invoke(app, ["simulate", "--network", "late:x"])
    assert isinstance(refused.exception, SpecError)


def test_live_while_it_runs(late):
    executor = VirtualExecutor(0)
    ends = [executor.wire()[0] for _ in range(2)]
    node = NetemNode(*ends, Emulation(parse_spec("constant:5"), parse_spec("constant:5"), 1))
    asked = {"do": "add", "direction": "uplink", "spec": "late:3"}
    assert json.loads(handle(node, json.dumps(asked).encode(), 10))["specs"] == {
        "uplink": "constant:5 late:3,20",
        "downlink": "constant:5",
    }
    Action(do="remove", direction="uplink", name="late").perform(node, 20)
    assert str(node.directions["uplink"].chain.spec) == "constant:5"
    with pytest.raises(InputError, match=r"remove: no such thing as 'lte'; one of outage, .*, late, "):
        Action(do="remove", name="lte").check()


def test_the_kernel_refuses_it_in_one_line(late):
    with pytest.raises(SpecError, match=r"--backend tc: late:3,20: tc-netem has nothing like it; use"):
        kernel_network(parse_spec("constant:5 late:3"), "uplink")


def test_every_word_of_ours_says_its_name_kind_stage_and_example():
    for name in BUILT_IN:
        word = word_called(name)
        assert word.kind
        assert isinstance(word.stage, Stage)
        for example in word.example.split(" or ") if word.example else (name,):
            parse_spec(example)
