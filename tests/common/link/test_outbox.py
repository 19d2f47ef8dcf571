"""The outbox against a model: a list a key, emptied in turn."""

import threading
from collections import Counter, deque

from hypothesis import given
from hypothesis import strategies as st

from farhand.common.link.delivery import CLASSES, class_of
from farhand.common.link.link import Packet
from farhand.common.link.outbox import Outbox

KEYS = ("farhand/a/command", "farhand/a/scene", "farhand/a/state", "farhand/a/camera/left", "other/x")


class Model:
    """What the outbox should do, the slow and simple way."""

    def __init__(self, limit):
        self.limit, self.waiting, self.order = limit, {key: [] for key in KEYS}, deque()
        self.dropped, self.replaced = Counter(), Counter()

    def put(self, packet):
        mine, name = self.waiting[packet.key], class_of(packet.key)
        if not mine:
            self.order.append(packet.key)
        elif CLASSES[name].keep == "newest":
            mine.clear()
            self.replaced[name] += 1
        elif len(mine) == self.limit:
            mine.pop(0)
            self.dropped[name] += 1
        mine.append(packet.payload)

    def pop(self):
        key = self.order.popleft()
        payload = self.waiting[key].pop(0)
        if self.waiting[key]:
            self.order.append(key)
        return key, payload


@given(st.integers(1, 5), st.lists(st.sampled_from((*KEYS, *KEYS, None)), max_size=80))
def test_it_does_as_the_model_does(limit, calls):
    box, model = Outbox(limit), Model(limit)
    for number, key in enumerate(calls):
        if key is not None:
            packet = Packet(key, b"%d" % number)
            box.put(packet)
            model.put(packet)
        elif model.order:
            found = box.pop()
            assert (found.key, found.payload) == model.pop()
    box.close()
    while model.order:
        found = box.pop()
        assert (found.key, found.payload) == model.pop()
    assert box.pop() is None
    assert (box.dropped, box.replaced) == (model.dropped, model.replaced)


def drained(box):
    box.close()
    return list(iter(box.pop, None))


@given(st.lists(st.sampled_from(KEYS), max_size=200), st.integers(0, 3000))
def test_a_chatty_key_neither_pushes_out_nor_holds_up_another(others, chatter):
    box = Outbox()
    for number in range(chatter):
        box.put(Packet("farhand/chatty/state", b"%d" % number))
    for number, key in enumerate(others):
        box.put(Packet(key, b"%d" % number))
    found = drained(box)
    for key in set(others):
        mine = [p.payload for p in found if p.key == key]
        sent = [b"%d" % number for number, each in enumerate(others) if each == key]
        assert mine == (sent if CLASSES[class_of(key)].keep == "every" else sent[-1:])
    # Each key has its turn: the k-th packet of a key leaves within the first k rounds.
    seen = Counter()
    for place, packet in enumerate(found):
        seen[packet.key] += 1
        assert place < seen[packet.key] * (len(set(others)) + 1)


def test_a_packet_may_say_otherwise_than_its_class():
    box = Outbox()
    for number in range(3):
        box.put(Packet("farhand/r/command", b"%d" % number, keep="newest"))
        box.put(Packet("farhand/r/scene", b"%d" % number, keep="every"))
    assert [(p.key[-5:], p.payload) for p in drained(box)] == [
        ("mmand", b"2"), ("scene", b"0"), ("scene", b"1"), ("scene", b"2"),
    ]  # fmt: skip


def test_invented_keys_take_no_more_than_their_places():
    box = Outbox(max_keys=4)
    for number in range(100):
        box.put(Packet(f"k/{number}", b""))
    box.put(Packet("k/0", b"again"))
    assert [p.key for p in drained(box)] == ["k/0", "k/1", "k/2", "k/3", "k/0"]
    assert box.dropped == {"other": 96}


def test_who_waits_is_woken_by_a_packet_and_by_the_end():
    box, found = Outbox(), []
    thread = threading.Thread(target=lambda: found.extend(iter(box.pop, None)))
    thread.start()
    box.put(Packet("k", b"x"))
    box.close()
    thread.join(10)
    assert [p.payload for p in found] == [b"x"]
