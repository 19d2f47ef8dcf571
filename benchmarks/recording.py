"""What a recording costs: the operator's program a tick, virtual time a run, the disk a minute.

`python -m benchmarks.recording [--quick] [--json FILE]`. The ticks are those of a simulated UR5 over 5g-urban. The
loop's thread hands a tick over; the recorder's requests, 5 a second, are answered by another thread, which costs the
program time as well, as both want its interpreter. A minute's pictures are as many bytes as the recorder takes at most.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.report import repeated
from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.report import ControlReport
from farhand.common.recording.batch import TickBatch
from farhand.common.recording.reader import RecordedRun, read_run
from farhand.common.timing.clock import stopwatch_seconds, thread_seconds
from farhand.laboratory.simulation import simulate
from farhand.operator_side.accounts.tick_history import KEPT, TickHistory
from farhand.programs.recorder import ASK_EVERY, FRAMES_BYTES

SCENARIO, NETWORK, SECONDS, QUICK = "ur5-obstacle", "5g-urban", 30.0, 1.0
MOST_TICK, MOST_MINUTE = 50e-6, 6e6
"""s, bytes."""


def of_a_tick(run: RecordedRun, rounds: int) -> dict[str, float]:
    """Seconds that a tick costs: in the loop's thread, and by the answers to the recorder."""
    decode = Decoder(ControlReport).decode_or_raise
    ticks = [
        (
            each.now_ns,
            [Packet(key, payload, at) for key, at, payload in each.packets],
            each.command,
            decode(each.report),
        )
        for each in run.ticks
    ]
    history = TickHistory()
    in_loop, answered = [], list[float]()
    wanted = 0
    a_request = max(1, round(ASK_EVERY / ((ticks[-1][0] - ticks[0][0]) * 1e-9 / (len(ticks) - 1))))
    for number in range(rounds * len(ticks)):
        now_ns, packets, command, report = ticks[number % len(ticks)]
        began = thread_seconds()
        history.tick(now_ns, packets, command, report)
        in_loop.append(thread_seconds() - began)
        if number % a_request == a_request - 1:
            began = thread_seconds()
            records, more = history.since(wanted)
            batch = TickBatch(info=run.info, ticks=records, more=more, ended=False)
            msgspec.msgpack.encode(batch)
            answered.append((thread_seconds() - began) / a_request)
            wanted += len(records)
    full = np.array(answered[KEPT // a_request :] or answered)  # once the history is as long as it gets
    return {
        "loop_median": float(np.median(in_loop)),
        "loop_p99": float(np.percentile(in_loop, 99)),
        "answer_median": float(np.median(full)),
        "answer_p99": float(np.percentile(full, 99)),
    }


def measure(folder: Path, seconds: float) -> dict[str, float]:
    """All of it: s and bytes."""
    path = folder / "run.mcap"
    simulate(SCENARIO, network=NETWORK, time_limit=min(1.0, seconds))  # imports and compiled code
    spent: dict[bool, list[float]] = {True: [], False: []}
    for recorded in (True, False, True, False):
        began = stopwatch_seconds()
        simulate(SCENARIO, network=NETWORK, time_limit=seconds, record_to=path if recorded else None)
        spent[recorded].append(stopwatch_seconds() - began)
    run = read_run(path)
    minute = folder / "minute.mcap"
    period = (run.ticks[-1].now_ns - run.ticks[0].now_ns) * 1e-9 / (len(run.ticks) - 1)
    repeated(path, minute, round(60.0 / period))
    found = of_a_tick(run, 2 if seconds < SECONDS else 60)
    found["virtual_time_share"] = min(spent[True]) / min(spent[False]) - 1.0
    found["minute_bytes"] = float(minute.stat().st_size)
    found["minute_bytes_with_camera"] = found["minute_bytes"] + 60.0 * FRAMES_BYTES
    return found


def main() -> int:
    """Print what was measured; returns 1 where it is more than promised."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", type=Path)
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = measure(Path(folder), QUICK if options.quick else SECONDS)
    micro = {name: value * 1e6 for name, value in found.items() if name.startswith(("loop", "answer"))}
    print("a tick costs, µs:", ", ".join(f"{name} {value:.1f}" for name, value in micro.items()))
    print(f"recording adds {found['virtual_time_share']:.0%} to virtual time")
    print(
        f"a minute has {found['minute_bytes'] / 1e6:.2f} MB, with a camera at most "
        f"{found['minute_bytes_with_camera'] / 1e6:.2f} MB"
    )
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    dear = found["loop_median"] + found["answer_median"] > MOST_TICK
    large = found["minute_bytes_with_camera"] > MOST_MINUTE
    return 1 if (dear or large) and not options.quick else 0


if __name__ == "__main__":
    sys.exit(main())
