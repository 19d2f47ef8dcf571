"""`farhand replay`: what it prints and how it ends."""

from pathlib import Path

from rich.console import Console
from rich.table import Table

from farhand.common.errors import InputError
from farhand.common.process.console import page, whole
from farhand.common.process.outputs import check_writable
from farhand.common.result_file import write_whole
from farhand.laboratory.replay import Replay, differing_fields, replay, side_by_side, to_csv, to_json


def run_replay(path: Path, settings: dict[str, object], out: Path | None, as_json: bool) -> int:
    """Replay and say what came out; returns 1 when nothing was changed and decisions differ or cannot be judged."""
    console = page(stderr=as_json, highlight=False)
    check_writable(out, "--out")
    result = replay(path, settings)
    for line in result.run.flaws():
        console.print(line, style="yellow")
    if result.run.cut_off:
        console.print(
            f"the file was cut off: {len(result.ticks)} whole ticks are readable of its {result.run.size} bytes",
            style="yellow",
        )
    if result.changed:
        _compare(result, console)
    else:
        _verify(result, console)
    if out is not None:
        try:
            write_whole(out, to_csv(result))
        except OSError as error:
            raise InputError(f"--out {out}: cannot be written: {error.strerror}") from None
    if as_json:
        print(to_json(result), flush=True)
    return 0 if result.changed or (result.identical and not result.unjudged) else 1


def _verify(result: Replay, console: Console) -> None:
    first = result.first_difference
    n = len(result.judged)
    if first is None:
        every = "all" if n == len(result.ticks) else "before the first gap all"
        console.print(f"{every} {n} decisions are identical to the byte", style="green")
        if n < len(result.ticks):
            rest = len(result.ticks) - n
            console.print(f"the {rest} after it cannot be judged: they follow from ticks that are missing")
        return
    same = sum(tick.identical for tick in result.judged)
    fields = ", ".join(differing_fields(first)) or "the command's bytes"
    console.print(
        f"{same} of {n} decisions are identical; the first other one is tick {first.number}: {fields}"
    )
    for name, (then, now) in result.other_versions().items():
        console.print(f"recorded with {name} {then}, this is {now}", style="yellow")


def _compare(result: Replay, console: Console) -> None:
    table = Table(caption="each tick begins from the commands that the robot really got")
    for heading in ("", "recorded", "decided now"):
        table.add_column(heading, justify="left" if not heading else "right")
    for texts in side_by_side(result):
        table.add_row(*texts)
    console.print(whole(table, console))
    other = [tick for tick in result.ticks if tick.difference > 1e-3]
    line = f"{len(other)} of {len(result.ticks)} velocities differ by more than 1 mm/s"
    if other:
        most = max(other, key=lambda tick: tick.difference)
        since = (most.now_ns - result.ticks[0].now_ns) * 1e-9
        line += f", at most by {most.difference:.3f} m/s, {since:.1f} s after the first tick"
    console.print(line)
