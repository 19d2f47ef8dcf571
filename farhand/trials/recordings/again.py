"""Recordings, again: are all decisions the same to the byte, and is the recorded network the same message by message?

`python -m farhand.trials.recordings.again [--runs N] [--real N] [--scenario NAME] [--json FILE]`. Each run has a seed
of its own and the next of the named networks; in virtual time it is replayed, and done once more over its own recorded
network. `--real` does demos instead, in real time, which are replayed. Exit code 1: something differs.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import msgspec

from farhand.common.recording.fates import FATE_TOPICS, Fate
from farhand.common.recording.reader import Entry, RunReader
from farhand.laboratory.replay import replay
from farhand.laboratory.simulation import simulate
from farhand.netem.models.profiles import PROFILES
from farhand.runs.files import RECORDING

SCENARIO, TIME_LIMIT = "ur5-obstacle", 40.0
Messages = dict[tuple[str, str, int, bool], tuple[int, int, int, int, str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """What came of one run.

    Attributes:
        network, seed: of it.
        decisions, identical: ticks that were replayed, and that were the same to the byte.
        complete: whether every tick of the run is in its recording.
        messages: that the emulator had; 0: the run was not done once more.
        other: of them, those that had another fate or delay the second time, or were not there.
        same_bytes: whether all that the operator sent and got was the same the second time; None: not done.
    """

    network: str
    seed: int
    decisions: int
    identical: int
    complete: bool
    messages: int = 0
    other: int = 0
    same_bytes: bool | None = None

    @property
    def holds(self) -> bool:
        """Whether everything is as promised."""
        decided = self.complete and 0 < self.decisions == self.identical
        return decided and not self.other and self.same_bytes is not False


def fates_of(path: Path) -> Messages:
    """What became of every message: when it came, its delays, the bit that was flipped, its fate."""
    topics = set(FATE_TOPICS.values())
    decode = msgspec.json.Decoder(Fate).decode
    found: Messages = {}
    for entry in RunReader(path).items(lambda topic: topic in topics):
        if isinstance(entry, Entry):
            fate = decode(entry.data)
            name = fate.direction, fate.key, fate.number, fate.copy
            delays = fate.arrived_ns, fate.assigned_ns, fate.achieved_ns
            found[name] = (*delays, fate.corrupted, fate.fate)
    return found


def virtual_run(scenario: str, network: str, seed: int, folder: Path) -> Row:
    """A run in virtual time, its replay, and the run over its recorded network."""
    first, second = folder / "first.mcap", folder / "second.mcap"
    once = simulate(scenario, network=network, seed=seed, time_limit=TIME_LIMIT, record_to=first, digest=True)
    twice = simulate(
        scenario, network=f"recorded:{first}", seed=seed, time_limit=TIME_LIMIT, record_to=second, digest=True
    )
    then, now = fates_of(first), fates_of(second)
    other = sum(then.get(name) != now.get(name) for name in then | now)
    replayed = _replayed(first, network, seed)
    return replace(replayed, messages=len(then), other=other, same_bytes=once.digest == twice.digest)


def real_run(scenario: str, network: str, seed: int, folder: Path) -> Row:
    """A demo, and its replay."""
    run = folder / f"{seed}-{network}"
    words = ["demo", "--scenario", scenario, "--network", network, "--seed", str(seed), "--out", str(run)]
    subprocess.run(
        [sys.executable, "-m", "farhand", *words, "--time-limit", str(TIME_LIMIT)],
        check=False,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    return _replayed(run / RECORDING, network, seed)


def _replayed(path: Path, network: str, seed: int) -> Row:
    found = replay(path)
    same = sum(tick.identical for tick in found.ticks)
    complete, ticks = found.run.complete, len(found.ticks)
    return Row(network=network, seed=seed, decisions=ticks, identical=same, complete=complete)


def main() -> int:
    """Do the runs, a line each, and what they come to."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--runs", type=int, default=100, help="in virtual time")
    parser.add_argument("--real", type=int, default=0, help="demos in real time instead, so many")
    parser.add_argument("--scenario", default=SCENARIO)
    parser.add_argument("--json", type=Path, help="write all rows to this file as well")
    options = parser.parse_args()
    networks = sorted(PROFILES)
    do = real_run if options.real else virtual_run
    rows: list[Row] = []
    for seed in range(options.real or options.runs):
        with tempfile.TemporaryDirectory() as folder:
            row = do(options.scenario, networks[seed % len(networks)], seed, Path(folder))
        rows.append(row)
        print(f"{seed:4d} {row.network:15} {_words(row)}", flush=True)
    if options.json:
        options.json.write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n", encoding="utf-8")
    identical = sum(row.complete and 0 < row.decisions == row.identical for row in rows)
    print(f"{identical} of {len(rows)} recordings replay to the byte", end="")
    if not options.real:
        same = sum(not row.other and bool(row.same_bytes) for row in rows)
        print(f"; over {same} of {len(rows)} recorded networks everything is the same", end="")
        print(f" ({sum(row.messages for row in rows)} messages)", end="")
    print()
    return 0 if all(row.holds for row in rows) else 1


def _words(row: Row) -> str:
    words = f"{row.identical} of {row.decisions} decisions identical"
    if not row.complete:
        words += ", the recording is not complete"
    if row.messages:
        words += f"; {row.other} of {row.messages} messages otherwise over the recorded network"
        words += "" if row.same_bytes else ", and other bytes"
    return words


if __name__ == "__main__":
    sys.exit(main())
