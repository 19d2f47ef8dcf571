"""A camera over a link of a given rate: it never delays anything else, and only its newest picture waits."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.netem.impairments.low_lane import SUPERSEDED
from tests.netem.test_netem_node import Rig

MBIT_2 = 2_000_000
STATE, PICTURE = 400, 8_000  # bytes of each, as those of an arm at 320x240


def deliveries(sends, network="rate:2mbit", until=20_000):
    """(instant of delivery, payload) by kind, and the emulator's statistics; `sends` are (ms, kind, payload)."""
    rig = Rig(network)
    for time, kind, payload in sends:
        rig.send(time, "robot", f"farhand/r/{kind}", payload)
    found = rig.run(until)
    rig_received = []
    for packet in rig.operator.receive():
        rig_received.append((packet.key.rpartition("/")[2], packet.arrived_ns - 1000, packet.payload))
    return rig_received, found["downlink"]


def of_kind(found, kind):
    return [(at, payload) for name, at, payload in found if name == kind]


def states(every=10, until=4000):
    return [(t, "state", t.to_bytes(4, "big") + bytes(STATE - 4)) for t in range(0, until, every)]


def camera(every=50, until=4000, size=PICTURE):
    return [(t + 3, "camera", t.to_bytes(4, "big") + bytes(size - 4)) for t in range(0, until, every)]


@pytest.mark.parametrize("network", ["rate:2mbit", "rate:2mbit constant:20", "rate:2mbit gaussian:50,20"])
def test_states_leave_at_the_same_nanosecond_with_and_without_a_camera(network):
    alone, _ = deliveries(states(), network)
    beside, counts = deliveries(states() + camera(), network)
    assert of_kind(beside, "state") == of_kind(alone, "state")
    assert len(of_kind(beside, "camera")) == 80  # 1.28 of 2 Mbit/s, beside 0.32 of the states
    assert counts["dropped"] == {}


def test_the_same_bytes_under_another_key_would_delay_them():
    """What the lane is good for: without it a state waits for a whole picture."""
    sends = states() + [(t, "other", payload) for t, _, payload in camera()]
    (alone, _), (beside, _) = deliveries(states()), deliveries(sends)
    late = [b - a for (a, _), (b, _) in zip(of_kind(alone, "state"), of_kind(beside, "state"), strict=True)]
    assert max(late) == 25_000_000


def test_a_picture_has_what_the_others_leave():
    found, _ = deliveries([(0, "camera", bytes(2500)), (4, "state", bytes(250)), (6, "state", bytes(500))])
    # 10 ms of its own, and 1 and 2 ms of the states in between.
    assert of_kind(found, "camera") == [(13_000_000, bytes(2500))]
    assert [at for at, _ in of_kind(found, "state")] == [5_000_000, 8_000_000]


def test_of_pictures_that_wait_only_the_newest_is_sent():
    sends = [(t, "camera", bytes([t]) + bytes(2499)) for t in range(6)]  # 10 ms each
    found, counts = deliveries(sends)
    assert [(at, payload[0]) for at, payload in of_kind(found, "camera")] == [
        (10_000_000, 0),
        (20_000_000, 5),
    ]
    assert counts["dropped"] == {SUPERSEDED: 4}


def test_a_link_that_others_fill_sends_no_picture_and_forgets_nothing():
    full = [(t, "state", bytes(500)) for t in range(0, 200, 2)]
    found, counts = deliveries([*full, (1, "camera", bytes(1000))])
    assert len(of_kind(found, "state")) == 100
    assert [at for at, _ in of_kind(found, "camera")] == [204_000_000]
    assert counts["dropped"] == {}


def test_over_a_network_that_repairs_pictures_hold_no_state_up():
    network = "rate:2mbit tcp-like:40 loss:10%"
    alone, _ = deliveries(states(), network)
    beside, _ = deliveries(states() + camera(), network)
    assert of_kind(beside, "state") == of_kind(alone, "state")


message = st.tuples(
    st.integers(0, 300), st.sampled_from(["state", "command", "camera"]), st.integers(1, 6_000)
)


@settings(max_examples=60, deadline=None)
@given(st.lists(message, max_size=40))
def test_whatever_is_sent_the_camera_takes_nothing_and_the_link_is_never_faster_than_it_is(sent):
    sends = [(t, kind, bytes(size)) for t, kind, size in sent]
    everything, counts = deliveries(sends)
    without, _ = deliveries([each for each in sends if each[1] != "camera"])
    for kind in ("state", "command"):
        assert of_kind(everything, kind) == of_kind(without, kind)
    assert counts["received"] == counts["delivered"] + sum(counts["dropped"].values())
    pictures = [(t, len(payload)) for t, kind, payload in sends if kind == "camera"]
    if pictures:
        assert of_kind(everything, "camera")  # one of them always gets through
        last = max(t for t, _ in pictures)
        assert max(at for at, _ in of_kind(everything, "camera")) > last * 1_000_000
    ends = sorted((at, len(payload)) for _, at, payload in everything)
    first = min((t for t, _, _ in sends), default=0) * 1_000_000
    for index, (at, _) in enumerate(ends):
        carried = sum(size for _, size in ends[: index + 1])
        assert carried * 8_000_000_000 // MBIT_2 <= at - first + len(ends)
