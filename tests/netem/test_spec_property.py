"""Any string is a Spec or a SpecError; any Spec's text is that Spec."""

from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.errors import SpecError
from farhand.netem.spec import parse_spec
from tests.examples import tries

numbers = st.floats(min_value=0, max_value=1e6).map(lambda x: f"{x:.6g}")
percentages = st.floats(min_value=0, max_value=99.9).map(lambda x: f"{x:.5g}%")
delays = st.one_of(
    st.builds("constant:{}".format, numbers),
    st.builds("gaussian:{},{}".format, numbers, numbers),
    st.builds("pareto:{},{}".format, numbers, numbers),
)
losses = st.one_of(
    st.builds("loss:{}".format, percentages),
    st.builds("loss:gilbert({},{})".format, percentages, percentages),
)
others = st.sampled_from(
    ["rate:2.5mbit", "slot:3,7,2,900B", "reorder:in-order", "tcp-like", "outage:random(3s,0.25s)"]
)
words = st.one_of(st.builds("{} {}".format, delays, losses), delays, losses, others)
specs = st.one_of(
    words, st.builds("{} camera[{}]".format, words, words), st.builds("{} state[none]".format, words)
)
alphabet = st.sampled_from(
    [*'0123456789.,:%()[]= \t"-e', "gaussian", "loss", "camera", "outage", "s", "ms", "trace"]
)


@given(specs)
@settings(max_examples=300, deadline=None)
def test_text_round_trip(text):
    spec = parse_spec(text)
    assert parse_spec(str(spec)) == spec
    assert str(parse_spec(str(spec))) == str(spec)


@st.composite
def damaged(draw):
    """A spec with one character replaced by up to three."""
    text = draw(specs)
    place = draw(st.integers(0, len(text)))
    return text[:place] + draw(st.text(max_size=3)) + text[place + 1 :]


@given(st.one_of(st.text(max_size=60), st.lists(alphabet, max_size=20).map("".join), damaged()))
@tries(400, of=1300)
def test_any_string_is_a_spec_or_a_spec_error(text):
    try:
        spec = parse_spec(text)
    except SpecError as error:
        lines = str(error).splitlines()
    else:
        lines = [str(spec)]
        assert parse_spec(lines[0]) == spec
    assert len(lines) == 1
