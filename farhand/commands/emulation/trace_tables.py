"""What the commands about traces print."""

import json
from collections.abc import Mapping
from typing import cast

import msgspec
from rich.console import Console
from rich.table import Table

from farhand.common.process.console import page, whole
from farhand.netem.models.model import DelayModel, Jitter, UniformJitter
from farhand.netem.recordings.trace import QUANTILES, Trace

Summary = Mapping[str, float | int | str | None]


def print_trace(trace: Trace, name: str, summary: Summary, correlation: Mapping[int, float]) -> None:
    """A trace's origin, quantiles and autocorrelation."""
    console = page()
    span = "no times" if trace.duration is None else f"{trace.duration:.1f} s"
    loss = 100 * cast(float, summary["loss"])
    console.print(f"{name}: {trace.kind}, {trace.provenance or 'source unknown'}", highlight=False)
    print_reading(trace, console)
    console.print(
        f"{summary['samples']} samples, {span}, {summary['lost']} lost ({loss:.2f} %)", highlight=False
    )
    table = Table(title="delay, ms", title_justify="left")
    for column in ("mean", "std", *QUANTILES):
        table.add_column(column, justify="right")
    table.add_row(*(in_ms(summary[column]) for column in ("mean", "std", *QUANTILES)))
    console.print(whole(table, console))
    lags = Table(title="autocorrelation, by the distance in samples", title_justify="left")
    for lag in correlation:
        lags.add_column(str(lag), justify="right")
    lags.add_row(*("-" if value != value else f"{value:.3f}" for value in correlation.values()))
    console.print(whole(lags, console))


def print_reading(trace: Trace, console: Console | None = None) -> None:
    """How the file was read, and what was assumed or left out."""
    console, reading = console or page(), trace.reading
    for what, how in reading.how.items():
        console.print(f"  {what}: {how}", highlight=False)
    console.print(f"  lost: {reading.lost_seen} seen, {reading.lost_inferred} inferred", highlight=False)
    for note in reading.notes:
        console.print(f"  note: {note}", highlight=False)


def print_fit(model: DelayModel, recorded: Summary, fitted: Mapping[float, float], lost: float) -> None:
    """Quantiles and loss of a recording and of the model fitted to it, and the model in words."""
    console = page()
    table = Table(title="recorded and fitted delays, ms", title_justify="left")
    table.add_column("")
    for name in QUANTILES:
        table.add_column(name, justify="right")
    table.add_column("lost", justify="right")
    kept = f"{100 * cast(float, recorded['loss']):.2f} %"
    table.add_row("recorded", *(in_ms(recorded[name]) for name in QUANTILES), kept)
    drawn = (in_ms(fitted[percent]) for percent in QUANTILES.values())
    table.add_row("fitted", *drawn, f"{100 * lost:.2f} %")
    console.print(whole(table, console))
    for line in _describe(model):
        console.print(line, highlight=False)


def in_ms(value: float | int | str | None) -> str:
    """Seconds in ms with four significant digits; a dash for what is no number."""
    return f"{float(value) * 1e3:.4g}" if isinstance(value, float | int) else "-"


def _describe(model: DelayModel) -> list[str]:
    lines = [f"floor {model.floor * 1e3:.4g} ms, {100 * model.loss:.2f} % single losses"]
    if model.jitter is not None:
        jitter = model.jitter
        lines.append(f"jitter {type(jitter).__name__}: {json.dumps(_rounded(jitter))}")
    for episodes in model.episodes:
        span = f"{episodes.shortest * 1e3:.4g} to {episodes.longest * 1e3:.4g} ms"
        when = "every" if episodes.periodic else "at random, on average every"
        extra = ""
        if episodes.kind == "slow":
            extra = f", {episodes.least_extra * 1e3:.4g} to {episodes.most_extra * 1e3:.4g} ms slower"
        lines.append(f"{episodes.kind}: {span}{extra}, {when} {episodes.interval:.4g} s")
    return lines


def _rounded(jitter: Jitter | UniformJitter) -> dict[str, float]:
    return {name: float(f"{value:.4g}") for name, value in msgspec.structs.asdict(jitter).items()}
