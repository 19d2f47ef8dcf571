"""The SPEC grammar: what it reads, and the line that it gives for what it cannot."""

import re

import pytest

from farhand.common.errors import SpecError
from farhand.netem.spec import NONE, parse_spec

CANONICAL = [
    "none",
    "constant:200",
    "constant:0.25",
    "uniform:50,200",
    "uniform:50,200,25%",
    "gaussian:50,20",
    "gaussian:50,20,99.5%",
    "pareto:50,20",
    "paretonormal:50,20,10%",
    "lognormal:50,20",
    "empirical:delays.csv",
    "trace:delays.csv,at_end=stop,unit=ms",
    'trace:"with space, and comma.txt"',
    "model:fitted.toml",
    "loss:1%",
    "loss:0.1%,25%",
    "loss:gilbert(1%,10%)",
    "loss:gilbert(1%,10%,70%,0.1%)",
    "loss:state(1%,20%,10%,30%,0.5%)",
    "loss:trace(delays.csv,gap=loss)",
    "duplicate:1%",
    "corrupt:0.1%,5%",
    "rate:2mbit",
    "rate:1500bit,64000B",
    "rate:trace(verizon.up)",
    "rate:trace(verizon.up,64000B)",
    "5g-urban",
    "loss:1% lund-stockholm",
    "slot:20",
    "slot:20,30,4",
    "slot:20,64000B",
    "slot:20,30,64000B",
    "slot:20,30,4,64000B",
    "slot:normal(20,5)",
    "slot:pareto(20,5,4)",
    "slot:paretonormal(20,5,4,64000B)",
    "slot:normal(20,5,64000B)",
    "reorder:drawn",
    "reorder:in-order",
    "reorder:gap(5)",
    "reorder:gap(5,50%,25%)",
    "outage:every(30s,2s)",
    "outage:at(5s,2s,12s,1s,hold)",
    "outage:random(30s,500ms)",
    "tcp-like",
    "tcp-like:300",
    "loss:1% rate:2mbit gaussian:50,20 state[none] camera[loss:5% rate:1mbit]",
]

NOT = [
    ("gaussian:50", 12, "expected ',' and the standard deviation in ms, e.g. gaussian:50,20"),
    ("gaussian:,20", 10, "expected the mean delay"),
    ("constant", 9, "expected ':' and the delay"),
    ("constant:-3", 10, "cannot be negative"),
    ("constant:nan", 10, "expected the delay"),
    ("constant:inf", 10, "expected the delay"),
    ("constant:1e300", 10, "too large"),
    ("constant:5h", 11, "expected a space"),
    ("constant:50,25%", 12, "no jitter"),
    ("gaussian:50,0,25%", 14, "correlation without jitter"),
    ("gaussian:50,20,100%", 16, "below 100%"),
    ("uniform:200,50", 13, "smaller than the smallest"),
    ("lognormal:0,5", 11, "above 0"),
    ("loss:101%", 6, "above 1"),
    ("loss:1.5", 6, "above 1"),
    ("loss:gilbert(1%)", 16, "expected ',' and r"),
    ("loss:state(60%,50%,60%)", 15, "must not be above 100%"),
    ("rate:0mbit", 6, "above 0"),
    ("rate:2", 7, "unit"),
    ("rate:2mbit,0kB", 12, "above 0"),
    ("slot:0", 6, "at least 0.01 ms"),
    ("slot:20,30,1.5", 12, "from 1 on"),
    ("slot:20,30,4,5", 15, "expected the size's unit"),
    ("slot:flat(20,5)", 6, "its distribution: normal, pareto, paretonormal"),
    ("slot:normal(0,5)", 13, "at least 0.01 ms"),
    ("slot:normal(20)", 15, "the standard deviation in ms"),
    ("slot:normal(20,5", 17, "expected ')'"),
    ("outage:every(2s,3s)", 14, "below the period"),
    ("outage:at(5s)", 11, "pairs"),
    ("outage:at(5s,2s,6s,1s)", 11, "in order"),
    ("outage:never", 8, "every(...)"),
    ("reorder:gap(0)", 13, "from 1 on"),
    ("tcp-like:0", 10, "at least 1 ms"),
    ("gausian:50,20", 1, "is 'gaussian' meant?"),
    ("loss:1% loss:2%", 9, "a second loss"),
    ("none loss:1%", 6, "'none' stands alone"),
    ("loss:1%rate:2mbit", 8, "expected a space"),
    ("telemetry[none]", 1, "no class of messages"),
    ("camera[none] camera[none]", 14, "there twice"),
    ("camera[loss:1%", 15, "expected ']'"),
    ("camera[]", 8, "the class's words"),
    ("trace:x.csv,colour=red", 13, "expected an option"),
    (
        "trace:x.csv,at_end=stop,gap=hole",
        29,
        "gap is one of auto, loss, delay, ignore, e.g. trace:delays.csv",
    ),
    ("loss:trace(x.csv,at_end=never)", 25, "at_end is one of wrap, stop, hold"),
    ('trace:"x.csv', 7, "not closed"),
    ("", 1, "expected a network"),
]


@pytest.mark.parametrize("text", CANONICAL)
def test_canonical_text_comes_back_unchanged(text):
    assert str(parse_spec(text)) == text


def test_order_and_units_do_not_matter():
    assert parse_spec("rate:2000kbit gaussian:0.05s,20ms loss:0.01") == parse_spec(
        "  loss:1%   gaussian:50,20 rate:2mbit "
    )
    assert parse_spec("normal:50,20") == parse_spec("gaussian:50,20")


@pytest.mark.parametrize(("text", "place", "words"), NOT)
def test_error_points_at_the_character(text, place, words):
    with pytest.raises(SpecError) as found:
        parse_spec(text)
    message = str(found.value)
    assert f"at character {place}:" in message
    assert words in message
    assert "\n" not in message


def test_control_characters_do_not_reach_the_terminal():
    with pytest.raises(SpecError) as found:
        parse_spec("loss\x1b[31m\n")
    assert re.fullmatch(r"[^\x00-\x1f]+", str(found.value))


def test_words_replace_those_of_their_kind():
    spec = parse_spec("gaussian:50,20 loss:1%").with_words(parse_spec("constant:5 camera[none]"))
    assert str(spec) == "loss:1% constant:5 camera[none]"
    assert str(spec.without("loss")) == "constant:5 camera[none]"
    assert spec.without("camera").without("delay") == parse_spec("loss:1%")
    assert spec.without("rate") is None
    assert parse_spec("loss:1%").without("loss") == NONE


def test_a_class_takes_its_own_words_and_shares_the_rest():
    spec = parse_spec("rate:2mbit loss:1% constant:5 camera[loss:5%] scene[none]")
    assert [(w.text(), own) for w, own in spec.words_for("camera")] == [
        ("loss:5%", True),
        ("rate:2mbit", False),
        ("constant:5", False),
    ]
    assert spec.words_for("scene") == ()
    assert [w.text() for w, _ in spec.words_for("command")] == ["loss:1%", "rate:2mbit", "constant:5"]
