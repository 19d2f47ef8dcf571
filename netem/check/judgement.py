"""What a check of the proxy found in one direction: counts, errors, distribution, replay in virtual time."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from farhand.common.link.link import Packet
from farhand.common.timing.clock import NANOSECONDS_PER_SECOND
from farhand.netem.chain import Chain
from farhand.netem.spec import Spec

MIN_KS_SAMPLES = 20


def judge(
    rows: NDArray[np.void],
    spec: Spec,
    seed: int,
    direction: str,
    origin_ns: int,
    sent: int,
    arrived: list[int],
) -> dict[str, Any]:
    """The findings of one direction, as plain values; durations in s.

    Args:
        rows: the proxy's log of this direction's messages.
        spec, seed, direction: what the proxy was asked to do.
        origin_ns: arrival of the first message of all.
        sent: messages sent.
        arrived: ordinals of those that arrived, in order of arrival.
    """
    delivered = rows[rows["achieved_ns"] >= 0]
    taken = int(np.sum(rows["copy"] == 0))
    lost = {str(c): int(n) for c, n in zip(*np.unique(rows["fate"], return_counts=True), strict=True)}
    lost.pop("delivered", None)
    achieved, drawn, assigned = (
        _seconds(delivered, name) for name in ("achieved_ns", "drawn_ns", "assigned_ns")
    )
    originals = np.sort(rows[rows["copy"] == 0], order="ordinal")
    replayed = _virtual(originals, spec, seed, direction, origin_ns)
    reference = _virtual(originals, spec, seed + 1, direction, origin_ns)
    expected = _seconds(reference[reference["fate"] == "delivered"], "assigned_ns")
    same = bool(
        len(replayed) == len(rows)
        and np.array_equal(_ordered(replayed)["fate"], _ordered(rows)["fate"])
        and np.array_equal(_ordered(replayed)["assigned_ns"], _ordered(rows)["assigned_ns"])
    )
    found: dict[str, Any] = {
        "spec": str(spec),
        "sent": sent,
        "taken_in": taken,
        "duplicated": len(rows) - taken,
        "lost_as_drawn": lost,
        "delivered": len(delivered),
        "arrived": len(arrived),
        "accounted": sent == taken and len(delivered) == len(arrived) and sent > 0,
        "reordered_as_drawn": _overtaken(_by_release(delivered)),
        "reordered_on_arrival": _overtaken(arrived),
        "drawn": _describe(drawn),
        "assigned": _describe(assigned),
        "achieved": _describe(achieved),
        "error": _describe(np.maximum(0.0, achieved - assigned)),
        "replays": same,
    }
    if len(achieved) >= MIN_KS_SAMPLES and len(expected) >= MIN_KS_SAMPLES:
        from scipy.stats import ks_2samp  # takes a second to load

        test = ks_2samp(achieved, expected)
        found["ks"] = {"statistic": float(test.statistic), "p": float(test.pvalue), "n": len(achieved)}
    return found


def _seconds(rows: NDArray[np.void], name: str) -> NDArray[np.float64]:
    found: NDArray[np.float64] = rows[name] / NANOSECONDS_PER_SECOND
    return found


def _virtual(
    originals: NDArray[np.void], spec: Spec, seed: int, direction: str, origin_ns: int
) -> NDArray[np.void]:
    """The rows that the same arrivals give in virtual time."""
    chain = Chain(spec, seed, direction)
    offset_ns = 3_600_000_000_000 - origin_ns  # times on the wire are positive
    chain.start(origin_ns + offset_ns)
    rows = []
    for original in originals:
        arrived_ns = int(original["arrived_ns"]) + offset_ns
        packet = Packet(str(original["key"]), bytes(int(original["size"])), arrived_ns)
        for transit in chain.offer(packet, arrived_ns):
            assigned_ns = transit.release_ns - arrived_ns
            rows.append(
                (
                    direction,
                    packet.key,
                    transit.ordinal,
                    int(transit.is_copy),
                    transit.size,
                    int(original["arrived_ns"]),
                    transit.delay_ns,
                    assigned_ns,
                    -1 if transit.cause else assigned_ns,
                    transit.cause or "delivered",
                )
            )
    return np.array(rows, dtype=originals.dtype)


def _ordered(rows: NDArray[np.void]) -> NDArray[np.void]:
    return np.sort(rows, order=["ordinal", "copy"])


def _by_release(rows: NDArray[np.void]) -> list[int]:
    """Ordinals in the order in which they were to be released."""
    order = np.argsort(rows["arrived_ns"] + rows["assigned_ns"], kind="stable")
    found: list[int] = rows["ordinal"][order].tolist()
    return found


def _overtaken(numbers: Sequence[int]) -> int:
    """How many come after a larger one."""
    newest, count = -1, 0
    for number in numbers:
        if number < newest:
            count += 1
        newest = max(newest, number)
    return count


def _describe(values: NDArray[np.float64]) -> dict[str, float]:
    if not len(values):
        return dict.fromkeys(("mean", "std", "p50", "p99", "max"), 0.0)
    return {
        "mean": float(values.mean()),
        "std": float(values.std()),
        "p50": float(np.percentile(values, 50)),
        "p99": float(np.percentile(values, 99)),
        "max": float(values.max()),
    }
