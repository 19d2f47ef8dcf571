"""How old the console's news are."""

import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import mirror_key
from farhand.operator_side.console.picture import NEVER, Picture
from farhand.testing import state

SECOND = 1_000_000_000


def test_a_state_that_was_old_when_it_was_sent_is_as_old_as_that_from_the_first():
    picture = Picture("r")
    assert picture.ages(10 * SECOND)[1] == NEVER
    told = state(1, t_sent_ns=50 * SECOND, t_sample_ns=47 * SECOND)
    picture.take(Packet(mirror_key("r", "state"), encode(told), 10 * SECOND))
    assert picture.ages(10 * SECOND)[1] == pytest.approx(3.0)
    assert picture.ages(11 * SECOND)[1] == pytest.approx(4.0)
