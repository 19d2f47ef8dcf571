"""A recording of an hour, made of a short run's ticks again and again: time and memory of its report.

`python -m benchmarks.report [--quick] [--keep FOLDER] [--json FILE]`
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import msgspec

from farhand.common.recording.fates import Fate
from farhand.common.recording.reader import Entry, RunReader, read_run
from farhand.common.recording.records import TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.common.timing.clock import stopwatch_seconds
from farhand.foxglove.view import views_of
from farhand.laboratory.simulation import simulate

TICKS, QUICK = 36_000, 200
MOST_SECONDS, MOST_BYTES = 20.0, 500e6


def repeated(source: Path, target: Path, ticks: int) -> None:
    """The ticks and fates of a run one after another, with stamps that go on, until there are so many."""
    run = read_run(source)
    reader = RunReader(source)
    decode = msgspec.json.Decoder(Fate).decode
    fates = [
        decode(e.data) for e in reader.items(lambda t: t.startswith("/network/")) if isinstance(e, Entry)
    ]
    info = msgspec.structs.replace(run.info, epoch_ns=0)
    file = RunFile(target, info, views_of(info))
    first = run.ticks[0].now_ns
    length = run.ticks[-1].now_ns - first + 100_000_000
    for number in range(ticks):
        lap, k = divmod(number, len(run.ticks))
        tick, later = run.ticks[k], lap * length
        packets = tuple((key, at + later, payload) for key, at, payload in tick.packets)
        file.tick(TickRecord(number, tick.now_ns + later, packets, tick.command, tick.report))
        if k == len(run.ticks) - 1:
            for fate in fates:
                file.fate(msgspec.structs.replace(fate, arrived_ns=fate.arrived_ns + later), first)
    file.close()


_CHILD = """
import json, resource, sys
from farhand.cli import run
code = run(["report", sys.argv[1], "--out", sys.argv[2]])
used = resource.getrusage(resource.RUSAGE_SELF)
peak = next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM"))
print(json.dumps({"code": code, "processor_seconds": used.ru_utime + used.ru_stime, "peak_bytes": int(peak) * 1024}))
"""  # VmHWM: what rusage calls the peak holds that of whoever started it


def measure(recording: Path) -> dict[str, Any]:
    """Seconds and peak memory of `farhand report` in a process of its own."""
    out = recording.with_suffix(".html")
    began = stopwatch_seconds()
    done = subprocess.run(
        [sys.executable, "-c", _CHILD, str(recording), str(out)],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return {
        "seconds": stopwatch_seconds() - began,
        **json.loads(done.stdout.splitlines()[-1]),
        "recording_bytes": recording.stat().st_size,
        "page_bytes": out.stat().st_size,
    }


def main() -> int:
    """Print what was measured; returns 1 where it is more than promised."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    parser.add_argument("--keep", type=Path, help="folder for the recording, which is made once")
    options = parser.parse_args()
    ticks = QUICK if options.quick else TICKS
    with tempfile.TemporaryDirectory() as made:
        folder = options.keep or Path(made)
        recording = folder / f"{ticks}.mcap"
        if not recording.is_file():
            source = folder / "source.mcap"
            simulate(
                "ur5-obstacle",
                network="5g-urban",
                record_to=source,
                time_limit=5.0 if options.quick else 90.0,
            )
            repeated(source, recording, ticks)
        found = measure(recording)
    print(f"{ticks} ticks: {', '.join(f'{name} {value:.4g}' for name, value in found.items())}")
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    slow = found["processor_seconds"] > MOST_SECONDS or found["peak_bytes"] > MOST_BYTES
    return 1 if slow and not options.quick else 0


if __name__ == "__main__":
    sys.exit(main())
