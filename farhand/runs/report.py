"""How a run ended, for people and as JSON."""

from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from farhand.netem.measure.result import NetemCounts
from farhand.runs.summary import RunSummary, count_reasons, to_json
from farhand.runs.units import milliseconds


def print_outcome(
    summary: RunSummary,
    folder: Path | None,
    figure: Path | None,
    console: Console,
    *,
    as_json: bool,
) -> None:
    """Print the summary; with `as_json`, the last line on stdout is the summary as JSON."""
    console.print(_verdict(summary))
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", justify="right")
    table.add_column()
    for label, text in _rows(summary):
        table.add_row(label, text)
    drawn = _drawn_against_achieved(summary.counts.netem)
    if drawn:
        table.add_row("netem", drawn)
    console.print(table)
    if folder is not None:
        names = ["summary.json", *([figure.name] if figure else [])]
        console.print(
            Text.assemble(("results in ", "dim"), (f"{folder}/", "bold"), (f"  ({', '.join(names)})", "dim"))
        )
    if as_json:
        print(to_json(summary), flush=True)


def _verdict(summary: RunSummary) -> Text:
    safe = (" SAFE ", "bold white on green") if summary.safe else (" NOT SAFE ", "bold white on red")
    done = (
        (" FINISHED ", "bold white on green")
        if summary.finished
        else (" NOT FINISHED ", "bold black on yellow")
    )
    return Text.assemble(safe, " ", done, f"  {summary.why}" if summary.why else "")


def _rows(summary: RunSummary) -> list[tuple[str, str]]:
    if summary.min_clearance is None:
        clearance = "no obstacle in the scene, or unknown"
    else:
        clearance = f"{summary.min_clearance * 1e3:.1f} mm least (limit {summary.d_min * 1e3:g} mm)"
        if summary.min_arm_clearance is not None:
            clearance += f", whole arm {summary.min_arm_clearance * 1e3:.1f} mm"
    refused = f"{summary.refused} ({count_reasons(summary.refused_by.items())})" if summary.refused else "0"
    counts = f"intervened in {summary.interventions} of {summary.ticks} ticks"
    return [
        ("clearance", clearance),
        ("targets", f"{summary.targets_reached} of {summary.targets} in {summary.duration:.1f} s"),
        (
            "round trip",
            f"{milliseconds(summary.rtt_mean)} ± {milliseconds(summary.rtt_std)} ms with computing",
        ),
        (
            "filter",
            f"{counts}, no plan in {summary.infeasible}; {summary.controller}, solver {summary.solver}",
        ),
        ("robot", f"{summary.stops} stops, refused commands: {refused}"),
    ]


def _drawn_against_achieved(netem: NetemCounts | None) -> str:
    """`up 52.1 drawn, 52.2 achieved; down ...` in ms, from the emulator's statistics."""
    if netem is None:
        return ""
    return "; ".join(
        f"{label} {way.drawn.mean * 1e3:.2f} ms drawn, {way.achieved.mean * 1e3:.2f} ms achieved"
        for label, way in (("up", netem.uplink), ("down", netem.downlink))
    )
