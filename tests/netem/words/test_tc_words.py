"""Who types tc's own words is told ours; a bare 1 is asked about."""

import pytest

from farhand.common.errors import SpecError
from farhand.netem.spec import parse_spec
from farhand.netem.words.tc_words import in_our_words


@pytest.mark.parametrize(
    ("theirs", "ours"),
    [
        ("delay 100ms", "constant:100"),
        ("delay 100ms 20ms", "uniform:80,120"),
        ("delay 100ms 20ms 25%", "uniform:80,120,25%"),
        ("delay 50ms 20ms distribution normal loss 1%", "gaussian:50,20 loss:1%"),
        ("delay 0.1s 5000us", "uniform:95,105"),
        ("loss random 1% 25%", "loss:1%,25%"),
        ("loss gemodel 1% 10%", "loss:gilbert(1%,10%)"),
        ("duplicate 1 corrupt 0.1%", "duplicate:1% corrupt:0.1%"),
        ("delay 10ms reorder 25% 50% gap 5", "constant:10 reorder:gap(5,25%,50%)"),
        ("rate 2mbit limit 100", "rate:2mbit limit:100"),
        ("slot 20ms 30ms", "slot:20,30"),
        ("slot 800us", "slot:0.8"),
        ("slot 20ms packets 4", "slot:20,20,4"),
        ("slot 20ms 30ms bytes 64000 packets 4", "slot:20,30,4,64000B"),
        ("slot 20ms bytes 64000 loss 1%", "slot:20,64000B loss:1%"),
        ("slot distribution normal 20ms 5ms", "slot:normal(20,5)"),
        (
            "slot distribution pareto 20ms 5ms packets 4 bytes 9000 delay 10ms",
            "slot:pareto(20,5,4,9000B) constant:10",
        ),
    ],
)
def test_each_is_told_and_what_is_told_is_a_spec(theirs, ours):
    with pytest.raises(SpecError) as caught:
        parse_spec(theirs)
    assert str(caught.value).endswith(f"these are tc's own words; in a SPEC: {ours}")
    parse_spec(ours)


def test_what_has_no_word_of_ours_is_still_known_for_tcs():
    assert in_our_words("loss 1% ecn") == ""
    with pytest.raises(SpecError, match="tc's own words, which a SPEC writes with colons"):
        parse_spec("delay 10ms distribution experimental")


@pytest.mark.parametrize("text", ["loss:1", "duplicate:1", "corrupt:1.0", "loss:gilbert(1,10%)"])
def test_a_bare_one_is_asked_about(text):
    with pytest.raises(SpecError, match="is a bare 1: write 1%, or 100% for all"):
        parse_spec(text)


def test_all_is_said_with_its_sign():
    assert str(parse_spec("loss:100%")) == "loss:100%"
    assert str(parse_spec("trace:x.csv,share=1")) == "trace:x.csv,share=1.0"
