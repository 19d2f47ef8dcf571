import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.common.trust.rare_lines import MAX_KINDS
from farhand.common.trust.refusals import Refusals

START = "2026-11-25T10:31:52.088792Z"
ACCESS = "zenoh::net::routing::interceptor::access_control"
SECOND_NS = 1_000_000_000


def handshake(text):
    return f"{START}  WARN acc-0 ThreadId(05) zenoh_link_tls::unicast: {text}. Hint: increase the limit.\n"


def denied(deed, key, zid="9a8", name="operator.bob", thread="rx-1 ThreadId(10)"):
    who = f"{zid} on Interface(lo)+CertCommonName({name})+Transport(Tls)+{zid}" if name else f"{zid}"
    return f"{START} TRACE  {thread} {ACCESS}: {who} is unauthorized to {deed} (ingress) on {key}\n"


def kept_back(thread="rx-1 ThreadId(10)"):
    return f"{START} TRACE  {thread} zenoh::net::routing::interceptor: Msg intercepted!\n"


@pytest.fixture
def said():
    return []


@pytest.fixture
def refusals(said):
    return Refusals(said.append)


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("peer sent no certificates", "it showed no certificate"),
        ("invalid peer certificate: UnknownIssuer", "its certificate is of another authority"),
        ("invalid peer certificate: certificate expired: verification time 1", "its certificate has ended"),
        ("received fatal alert: DecryptError", "it does not trust this program's certificate"),
        ("received corrupt message of type InvalidContentType", "what it sent is not TLS"),
        ("something new", "something new"),
    ],
)
def test_each_kind_of_handshake_is_told_in_words(refusals, said, text, meaning):
    refusals.feed(handshake(text).encode(), 0)
    assert len(said) == 1
    assert said[0].startswith(f"refused a connection: {meaning}")
    assert "Hint" not in said[0]


def test_what_was_kept_back_is_told_and_a_look_in_advance_is_not(refusals, said):
    refusals.feed(denied("Put", "farhand/ur5/state").encode(), 0)  # nothing was intercepted after it
    assert said == []
    refusals.feed((denied("Put", "farhand/ur5/command") + kept_back()).encode(), 0)
    assert said == ["refused: operator.bob may not write farhand/ur5/command"]


def test_a_cached_denial_has_the_name_of_an_earlier_line(refusals, said):
    refusals.feed(denied("Put", "farhand/ur5/state").encode(), 0)
    line = denied("Declare Subscriber", "farhand/ur5/state", name="").replace(
        "9a8 ", "Using cached result: 9a8 "
    )
    refusals.feed((line + kept_back()).encode(), 0)
    assert said == ["refused: operator.bob may not read farhand/ur5/state"]


def test_threads_are_told_apart(refusals, said):
    other = "rx-0 ThreadId(09)"
    lines = denied("Put", "a") + denied("Put", "b", zid="7", name="robot.x", thread=other)
    refusals.feed((lines + kept_back() + kept_back(other)).encode(), 0)
    assert said == ["refused: operator.bob may not write a", "refused: robot.x may not write b"]


def test_a_flood_is_one_line_and_then_a_count(refusals, said):
    flood = (denied("Put", "farhand/ur5/command") + kept_back()) * 10_000
    refusals.feed(flood.encode(), SECOND_NS)
    refusals.tick(5 * SECOND_NS)
    assert len(said) == 1
    refusals.tick(11 * SECOND_NS)
    refusals.tick(30 * SECOND_NS)
    assert said[1:] == ["refused: operator.bob may not write farhand/ur5/command (9999 more)"]


def test_many_kinds_do_not_fill_the_screen(refusals, said):
    for number in range(1000):
        refusals.feed(handshake(f"oddity {number}").encode(), 0)
    assert len(said) == MAX_KINDS + 1
    assert said[-1] == "and other things, too many to tell apart"


@given(st.lists(st.integers(1, 40), min_size=1, max_size=40))
def test_cut_anywhere_it_says_the_same_and_lets_the_rest_pass(cuts):
    said = []
    text = ("\x1b[2mpybullet build\n" + denied("Put", "k") + kept_back() + "plain text\n").encode()
    refusals, passed, at = Refusals(said.append), b"", 0
    for length in [*cuts, len(text)]:
        passed += refusals.feed(text[at : at + length], 0)
        at += length
    assert said == ["refused: operator.bob may not write k"]
    assert b"plain text\n" in passed
    assert b"unauthorized" not in passed


def test_what_never_ends_a_line_passes(refusals, said):
    assert len(refusals.feed(b"x" * 100_000, 0)) == 100_000
    assert said == []
