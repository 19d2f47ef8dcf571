"""The inbox of a real link: order of arrival, bounds a key, nobody pushes out another."""

from hypothesis import given
from hypothesis import strategies as st

from farhand.common.link.keyed_inbox import MAX_KEYS, KeyedInbox
from farhand.common.link.link import Packet

KEYS = ("farhand/a/command", "farhand/a/state", "farhand/a/scene", "other/x")


@given(st.integers(1, 6), st.lists(st.sampled_from((*KEYS, None)), max_size=100))
def test_it_keeps_the_newest_of_each_key_in_order_of_arrival(limit, calls):
    inbox, expected, lost = KeyedInbox(limit, 1000, 2), [], 0
    for number, key in enumerate(calls):
        if key is None:
            assert [p.payload for p in inbox.drain()] == [b"%d" % n for n, _ in expected]
            expected = []
            continue
        inbox.put(Packet(key, b"%d" % number))
        expected.append((number, key))
        mine = [each for each in expected if each[1] == key]
        if len(mine) > (2 if key.endswith("scene") else limit):
            expected.remove(mine[0])
            lost += 1
    assert [p.payload for p in inbox.drain()] == [b"%d" % n for n, _ in expected]
    assert inbox.overflowed == lost
    assert inbox.drain() == []


@given(st.integers(0, 500))
def test_where_all_are_too_many_the_longest_gives_way(chatter):
    inbox = KeyedInbox(1000, 50)
    for key in KEYS:
        inbox.put(Packet(key, b"first"))
    for number in range(chatter):
        inbox.put(Packet("farhand/chatty/state", b"%d" % number))
    found = inbox.drain()
    assert [p.key for p in found[: len(KEYS)]] == list(KEYS)
    assert [p.payload for p in found[len(KEYS) :]] == [
        b"%d" % n for n in range(max(0, chatter - 50 + len(KEYS)), chatter)
    ]
    assert inbox.lost["state"] == max(0, chatter - 50 + len(KEYS))


def test_invented_keys_share_one_place_and_leave_the_known_ones_alone():
    inbox = KeyedInbox(10, 100_000)
    inbox.put(Packet("farhand/r/command", b""))
    for number in range(5000):
        inbox.put(Packet(f"invented/{number}", b""))
    found = inbox.drain()
    assert found[0].key == "farhand/r/command"
    assert len(found) == MAX_KEYS + 10
