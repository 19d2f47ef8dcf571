"""What each impairment does to messages, in virtual time."""

import itertools

import numpy as np
import pytest

from farhand.common.errors import TraceError
from farhand.common.link.link import Packet
from farhand.netem.chain import MAX_FLOWS, Chain
from farhand.netem.spec import parse_spec

MS = 1_000_000
COMMAND = "farhand/r/command"


def run(text, times_ms, *, key=COMMAND, size=100, seed=1):
    chain = Chain(parse_spec(text), seed, "uplink")
    return [offer(chain, t, key, size) for t in times_ms]


def offer(chain, time_ms, key=COMMAND, size=100):
    now_ns = round(time_ms * MS) + 1
    return chain.offer(Packet(key, bytes(size), now_ns), now_ns)


def released_ms(transits):
    return [None if t[0].cause else round((t[0].release_ns - 1) / MS, 6) for t in transits]


def test_rate_sends_one_byte_after_the_other():
    """100 bytes at 80 kbit/s are 10 ms."""
    assert released_ms(run("rate:80kbit", [0, 0, 5, 100])) == [10, 20, 30, 110]


def test_rate_drops_what_does_not_fit_the_queue():
    transits = run("rate:80kbit,250B", [0] * 10)
    assert [t[0].cause for t in transits] == ["", ""] + ["queue"] * 8


def test_camera_gives_way_on_the_link_that_it_shares():
    chain = Chain(parse_spec("rate:1mbit"), 1, "downlink")
    offer(chain, 0, "farhand/r/camera/front", 100_000)
    assert offer(chain, 1, "farhand/r/state", 100)[0].release_ns == 1_800_001
    chain = Chain(parse_spec("rate:1mbit"), 1, "downlink")
    offer(chain, 0, "farhand/r/video", 100_000)  # whatever is of no class of its own does not
    assert offer(chain, 1, "farhand/r/state", 100)[0].release_ns > 800 * MS


def test_class_none_passes_unimpaired():
    chain = Chain(parse_spec("constant:200 loss:100% camera[none]"), 1, "uplink")
    assert offer(chain, 0)[0].cause == "loss"
    assert released_ms([offer(chain, 7, "farhand/r/camera/a")]) == [7]


def test_periodic_outage_drops_or_holds():
    times = [0, 99, 100, 119, 120, 205, 230]
    assert released_ms(run("outage:every(100ms,20ms)", times)) == [0, 99, None, None, 120, None, 230]
    assert released_ms(run("outage:every(100ms,20ms,hold)", times)) == [0, 99, 120, 120, 120, 220, 230]


def test_scheduled_outages():
    times = [0, 5, 6, 7, 10, 12]
    assert released_ms(run("outage:at(5ms,2ms,10ms,1ms)", times)) == [0, None, None, 7, None, 12]


def test_random_outages_have_the_stated_shares():
    lost = [bool(t[0].cause) for t in run("outage:random(30ms,10ms)", [n * 0.5 for n in range(100_000)])]
    assert 0.23 < sum(lost) / len(lost) < 0.27


def test_slots_release_together():
    assert released_ms(run("slot:20", [0, 1, 19, 20, 21])) == [0, 20, 20, 20, 40]
    assert released_ms(run("slot:20,20,2", [0, 1, 2, 3, 4, 5])) == [0, 20, 20, 40, 40, 60]


def test_random_slots_lie_as_far_apart_as_stated():
    instants = sorted(set(released_ms(run("slot:20,30", [n * 5 for n in range(2000)]))))
    gaps = [b - a for a, b in itertools.pairwise(instants)]
    assert min(gaps) >= 20
    assert max(gaps) <= 30
    assert 24 < sum(gaps) / len(gaps) < 26


@pytest.mark.parametrize("name", ["normal", "pareto", "paretonormal"])
def test_slots_of_a_distribution_lie_as_it_says(name):
    instants = sorted(set(released_ms(run(f"slot:{name}(20,4)", [n * 5 for n in range(40_000)]))))
    gaps = np.diff(instants)
    assert gaps.mean() == pytest.approx(20, abs=0.3)
    assert gaps.std() == pytest.approx(4, abs=0.7)
    if name == "pareto":
        assert gaps.min() > 20 - 4 / 3**0.5 - 1e-6  # it has a shortest one


def test_a_spacing_drawn_below_nothing_is_the_smallest():
    instants = released_ms(run("slot:normal(0.02,1)", range(50)))
    assert instants == sorted(instants)


def test_a_slot_is_full_with_the_message_that_reaches_its_bytes():
    size = run("none", [0])[0][0].size
    over = released_ms(run(f"slot:20,{size + 1}B", [0, 1, 2, 3, 4]))
    assert over == [0, 20, 20, 40, 40]
    assert released_ms(run(f"slot:20,20,9,{size}B", [0, 1, 2])) == [0, 20, 40]
    assert released_ms(run(f"slot:20,20,1,{9 * size}B", [0, 1, 2])) == [0, 20, 40]
    assert released_ms(run(f"slot:normal(20,0,{size + 1}B)", [0, 1, 2, 3, 4])) == over


def test_slots_survive_a_long_silence():
    assert released_ms(run("slot:20", [0, 3_600_000_005])) == [0, 3_600_000_020]


def test_gap_sends_every_nth_at_once():
    assert released_ms(run("constant:50 reorder:gap(3)", [0, 10, 20, 30, 40, 50])) == [50, 60, 20, 80, 90, 50]


def test_in_order_waits_for_those_before():
    transits = run("gaussian:50,20 reorder:in-order", range(0, 4000, 4))
    instants = [t[0].release_ns for t in transits]
    assert instants == sorted(instants)


def test_tcp_like_brings_lost_messages_back_and_blocks_those_behind():
    lost = [bool(t[0].cause) for t in run("loss:20%", range(0, 4000, 4))]
    transits = run("loss:20% constant:10 tcp-like:200", range(0, 4000, 4))
    instants = [t[0].release_ns for t in transits]
    assert not any(t[0].cause for t in transits)
    assert instants == sorted(instants)
    assert transits[lost.index(True)][0].retransmissions >= 1
    first = lost.index(True)
    assert instants[first] >= (first * 4 + 210) * MS


def test_tcp_like_gives_up_at_last():
    assert run("loss:100% tcp-like", [0])[0][0].cause == "tcp-like"


def test_tcp_like_outlasts_an_outage_in_one_burst():
    transits = run("outage:at(100ms,2s) tcp-like", range(0, 3000, 10))
    assert not any(t[0].cause for t in transits)
    held = [t[0].release_ns for t in transits if 100 * MS < t[0].arrived_ns < 2100 * MS]
    assert min(held) > 2100 * MS
    assert len(set(held)) == 1


def test_duplicates_have_delays_of_their_own():
    transits = run("duplicate:100% gaussian:50,20", range(100))
    assert all(len(t) == 2 and t[1].is_copy for t in transits)
    assert sum(t[0].release_ns == t[1].release_ns for t in transits) == 0


def test_corrupt_flips_exactly_one_bit():
    for transits in run("corrupt:100%", range(200), size=16):
        ones = sum(bin(byte).count("1") for byte in transits[0].packet.payload)
        assert transits[0].corrupted >= 0
        assert ones == 1
    assert run("corrupt:100%", [0], size=0)[0][0].corrupted < 0


def fates(text, keys, seed=1):
    """(cause, delay) by key and ordinal, whatever the interleaving."""
    chain = Chain(parse_spec(text), seed, "uplink")
    found = {}
    for n, key in enumerate(keys):
        transit = offer(chain, n * 3.7, key)[0]
        found[key, transit.ordinal] = (transit.cause, transit.delay_ns, transit.corrupted)
    return found


def test_draws_do_not_depend_on_timing_or_on_other_keys():
    spec = "gaussian:50,20,30% loss:gilbert(5%,20%) duplicate:5% corrupt:5% outage:every(50ms,5ms)"
    both = fates(spec.replace(" outage:every(50ms,5ms)", ""), ["a/b/command", "a/b/state"] * 300)
    alone = fates(spec.replace(" outage:every(50ms,5ms)", ""), ["a/b/state"] * 300)
    assert all(both[key] == value for key, value in alone.items())
    with_outage = fates(spec, ["a/b/state"] * 300)
    assert [v[1:] for v in with_outage.values() if not v[0]] == [
        v[1:] for k, v in alone.items() if not with_outage[k][0]
    ]
    assert fates(spec, ["a/b/state"] * 300, seed=2) != with_outage


def test_live_change_keeps_the_state_of_what_stays():
    untouched = Chain(parse_spec("gaussian:50,20 loss:1%"), 1, "uplink")
    changed = Chain(parse_spec("gaussian:50,20"), 1, "uplink")
    for n in range(100):
        offer(untouched, n), offer(changed, n)
    changed.update(parse_spec("gaussian:50,20 loss:1%"))
    assert [offer(untouched, n)[0].delay_ns for n in range(100, 200)] == [
        offer(changed, n)[0].delay_ns for n in range(100, 200)
    ]


def test_changing_back_draws_afresh():
    chain = Chain(parse_spec("gaussian:50,20"), 1, "uplink")
    first = [offer(chain, n)[0].delay_ns for n in range(20)]
    chain.update(parse_spec("constant:1"))
    chain.update(parse_spec("gaussian:50,20"))
    assert [offer(chain, n)[0].delay_ns for n in range(20)] != first


def test_an_outage_now():
    chain = Chain(parse_spec("constant:1"), 1, "uplink")
    offer(chain, 0)
    chain.outage(10 * MS + 1, 5 * MS, hold=False)
    assert released_ms([offer(chain, t) for t in (10, 14.9, 15)]) == [None, None, 16]
    chain.outage(20 * MS + 1, 5 * MS, hold=True)
    assert released_ms([offer(chain, t) for t in (20, 30)]) == [26, 31]


def test_a_flood_of_keys_does_not_grow_the_memory():
    chain = Chain(parse_spec("gaussian:50,20"), 1, "uplink")
    for n in range(3 * MAX_FLOWS):
        offer(chain, n, f"farhand/x{n}/command")
    assert len(chain._flows) <= MAX_FLOWS + 1


def test_a_missing_file_is_an_input_error():
    with pytest.raises(TraceError, match=r"nowhere\.csv"):
        Chain(parse_spec("trace:/nowhere.csv"), 1, "uplink")


def test_rate_by_a_packet_delivery_trace(tmp_path):
    """1500 bytes may leave every 10 ms."""
    file = tmp_path / "link.up"
    file.write_text("".join(f"{n}\n" for n in range(10, 1010, 10)))
    found = released_ms(run(f"rate:trace({file},4000B)", [0, 1, 2, 3, 95], size=1500))
    assert found == [10, 20, None, None, 100]


def test_stalls_of_a_profile_come_to_all_keys_at_once():
    """`outages` loses everything for 2 s of every 10 s."""
    chain = Chain(parse_spec("outages"), 1, "downlink")
    keys = ("farhand/r/state", "farhand/r/scene", "farhand/q/state")
    lost = {key: [] for key in keys}
    for time_ms in range(0, 30_000, 10):
        for key in keys:
            lost[key].append(bool(offer(chain, time_ms, key)[0].cause))
    assert len({tuple(values) for values in lost.values()}) == 1
    assert 0.19 < sum(lost[keys[0]]) / 3000 < 0.21


@pytest.mark.parametrize("profile", ["bursty-loss-20", "outages", "5g-urban"])
def test_what_a_named_network_loses_is_counted_under_its_name(profile):
    """There is no trace, whatever its model is made of."""
    assert {t[0].cause for t in run(profile, range(0, 20_000, 50))} == {"", profile}
