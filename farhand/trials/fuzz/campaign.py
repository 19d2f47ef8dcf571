"""`farhand trial fuzz`: every target under atheris, piece by piece at the lowest priority; a campaign goes on.

A piece is a process of its own: what it found to be new is in the target's corpus, from which the next one starts. A
finding ends the piece; its input is kept, and the campaign says so at its end.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import msgspec
from rich.console import Console

from farhand.common.errors import InputError
from farhand.common.process.outputs import hold_folder, make_folder
from farhand.common.process.signals import PARENT_VARIABLE
from farhand.common.result_file import write_whole
from farhand.trials.fuzz.registry import NAMES, target_called

ROWS, TABLE = "pieces.jsonl", "fuzz.md"
MEMORY_MB = 512
"""What a process may take, its libraries included; more is a finding."""
LONGEST_INPUT = 10
"""s that one input may take; longer is a finding."""
STOPPED = (-signal.SIGTERM, -signal.SIGINT, -signal.SIGHUP)
"""Codes of a process that somebody ended: that is no finding."""
PIECE = 200_000
INPUTS = {
    "codec": 3_000_000, "robot-intake": 500_000, "scene-requests": 600_000, "scene-words": 400_000,
    "operator-messages": 700_000, "operator-tick": 10_000, "steering": 250_000, "console-page": 40_000,
    "live-control": 200_000, "requests": 600_000, "answers": 400_000,
    "network-spec": 1_000_000, "scenario": 80_000, "timeline": 200_000, "recording": 30_000,
    "trace": 150_000, "rate-and-model": 150_000,
    "ros2-cdr": 2_000_000, "mesh": 300_000, "urdf": 300_000, "srdf": 300_000,
    "capsules": 200_000, "sweep": 200_000, "ur-rtde-server": 600_000, "ur-rtde-client": 600_000,
    "ur-script": 100_000, "ur-dashboard": 300_000,
}  # fmt: skip
"""Of each target at --share 1: 13.2 million in all, each target about as long as the others."""


class Piece(msgspec.Struct, frozen=True, kw_only=True):
    """One process.

    Attributes:
        target: its name.
        inputs: that were taken.
        covered: edges of the instrumented code that the corpus reaches.
        corpus: inputs in it.
        memory: most that the process had (MB).
        finding: name of the input that broke a promise; empty: none did.
        said: the last line of what it raised.
    """

    target: str
    inputs: int
    covered: int
    corpus: int
    memory: int
    finding: str = ""
    said: str = ""


@dataclass(frozen=True, slots=True)
class Campaign:
    """Attributes:
    targets: their names.
    share: of INPUTS.
    out: its folder.
    """

    targets: tuple[str, ...]
    share: float
    out: Path

    def wanted(self, name: str) -> int:
        """Inputs of a target."""
        return max(1, round(self.share * INPUTS[name]))


def run_campaign(campaign: Campaign, workers: int) -> int:
    """Do what is missing, print the table; returns 0, or 1 where there is a finding. Raises InputError."""
    try:
        import atheris  # noqa: F401 (said here, before anything is begun)
    except ImportError:
        raise InputError("farhand trial fuzz needs atheris: pip install 'farhand[fuzz]'") from None
    console = Console(markup=False, highlight=False, soft_wrap=True)
    make_folder(campaign.out, "--out")
    hold_folder(campaign.out, "--out")
    rows = _read(campaign.out / ROWS)
    with (campaign.out / ROWS).open("a", encoding="utf-8") as kept, ThreadPoolExecutor(workers) as pool:

        def done(piece: Piece) -> None:
            rows.append(piece)
            kept.write(msgspec.json.encode(piece).decode() + "\n")
            kept.flush()
            whole = sum(row.inputs for row in rows)
            console.print(f"{piece.target}: {piece.inputs} inputs, {piece.covered} edges; {whole} inputs in all"
                          + (f"; FINDING {piece.finding}: {piece.said}" if piece.finding else ""))  # fmt: skip

        pieces = _Pieces(campaign.out)
        try:
            for _ in pool.map(lambda name: _fuzz(campaign, name, rows, pieces, done), campaign.targets):
                pass
        except BaseException:  # Ctrl-C, say: what has not ended is ended
            pieces.stop()
            raise
    text = table(rows)
    write_whole(campaign.out / TABLE, text)
    console.print(text)
    return 1 if any(row.finding for row in rows) else 0


def _fuzz(
    campaign: Campaign, name: str, rows: list[Piece], pieces: "_Pieces", done: Callable[[Piece], None]
) -> None:
    """The pieces of one target that are missing."""
    number = sum(row.target == name for row in rows)
    missing = campaign.wanted(name) - sum(row.inputs for row in rows if row.target == name)
    while missing > 0 and not pieces.stopped:
        piece = pieces.run(name, min(PIECE, missing), number + 1)
        done(piece)
        missing, number = missing - max(piece.inputs, 1), number + 1
        if piece.finding:
            return


class _Pieces:
    """Runs processes, in several threads.

    Args:
        out: the campaign's folder.

    Attributes:
        stopped: whether no further one is to begin.
    """

    def __init__(self, out: Path) -> None:
        self._out = out
        self._running: set[subprocess.Popen[bytes]] = set()
        self.stopped = False

    def stop(self) -> None:
        """End those that run, and begin none."""
        self.stopped = True
        for process in list(self._running):
            process.terminate()

    def run(self, name: str, inputs: int, number: int) -> Piece:
        """One, to its end."""
        corpus, findings, log = self._out / "corpus" / name, self._out / "findings", self._out / f"{name}.log"
        for folder in (corpus, findings):
            folder.mkdir(parents=True, exist_ok=True)
        options = [
            f"-runs={inputs}", f"-rss_limit_mb={MEMORY_MB}", f"-timeout={LONGEST_INPUT}", f"-seed={number}",
            f"-artifact_prefix={findings}/{name}-", "-print_final_stats=1", str(corpus),
        ]  # fmt: skip
        command = [*lowest_priority(), sys.executable, "-m", "farhand.trials.fuzz.one", name, *options]
        environment = {**os.environ, PARENT_VARIABLE: str(os.getpid())}
        with (
            log.open("wb") as said,
            subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT, env=environment) as process,
        ):
            self._running.add(process)
            code = process.wait()
            self._running.discard(process)
        piece = read_log(name, log.read_text(encoding="utf-8", errors="replace"))
        return msgspec.structs.replace(piece, finding="", said="") if code in STOPPED else piece


def lowest_priority() -> list[str]:
    """Words before a command that has only what nobody else wants."""
    words = ["chrt", "-i", "0"] if shutil.which("chrt") else []
    return [*words, *(["nice", "-n", "19"] if shutil.which("nice") else [])]


def read_log(name: str, text: str) -> Piece:
    """What a process did, by what libFuzzer said."""
    lines = re.findall(r"^#(\d+)\s.*?cov: (\d+) .*?corp: (\d+)/.*?rss: (\d+)Mb", text, re.MULTILINE)
    taken, covered, corpus, memory = map(int, lines[-1]) if lines else (0, 0, 0, 0)
    exact = re.search(r"stat::number_of_executed_units:\s*(\d+)", text)
    found = re.search(r"Test unit written to (\S+)", text)
    raised = re.findall(r"^([A-Za-z_.]+(?:Error|Exception)\b.*)$", text, re.MULTILINE)
    ended = exact is not None and found is None
    return Piece(
        target=name,
        inputs=int(exact.group(1)) if exact else taken,
        covered=covered,
        corpus=corpus,
        memory=memory,
        finding="" if ended else Path(found.group(1)).name if found else "no input",
        said="" if ended else (raised[-1] if raised else "it ended by itself")[:200],
    )


def table(rows: Sequence[Piece]) -> str:
    """The table as Markdown."""
    lines = [
        "| edge | asserted of every input | inputs | edges covered | memory, MB | findings |",
        "|---|---|---|---|---|---|",
    ]
    for name in NAMES:
        mine = [row for row in rows if row.target == name]
        if not mine:
            continue
        target = target_called(name)
        findings = sum(bool(row.finding) for row in mine)
        cells = (
            f"`{name}`: {target.edge}",
            target.promise,
            f"{sum(row.inputs for row in mine):,}",
            max(row.covered for row in mine),
            max(row.memory for row in mine),
            findings,
        )
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    lines.append(f"\n{sum(row.inputs for row in rows):,} inputs in all.")
    return "\n".join(lines) + "\n"


def _read(path: Path) -> list[Piece]:
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            rows.append(msgspec.json.decode(line, type=Piece))
        except (msgspec.MsgspecError, ValueError):
            continue  # the last line of a campaign that was killed
    return rows
