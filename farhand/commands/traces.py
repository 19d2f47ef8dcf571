"""`farhand trace`: look at recorded delays, record them, fit a model to them, convert them."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from farhand.common.errors import InputError

if TYPE_CHECKING:
    from farhand.netem.models.model import DelayModel
    from farhand.netem.recordings.formats.base import Kind
    from farhand.netem.recordings.gaps import Gap
    from farhand.netem.recordings.trace import Trace

trace_app = typer.Typer(
    help="Recorded network delays: show, record, fit a model, convert.", no_args_is_help=True
)

FileArgument = Annotated[Path, typer.Argument(help="The trace.", metavar="FILE")]
FormatOption = Annotated[
    str, typer.Option("--format", help="Name of the format, such as ping [default: by the content].")
]
UnitOption = Annotated[str, typer.Option("--unit", help="Unit of the delays: s, ms, us or ns.")]
ColumnOption = Annotated[str, typer.Option("--column", help="The delay's column: its name, or 1, 2, ...")]
PeriodOption = Annotated[float, typer.Option("--period", help="Length of a slot, in ms.")]
KindOption = Annotated[str, typer.Option("--kind", help="one-way or round-trip.")]
GapOption = Annotated[
    str, typer.Option("--gap", help="Rows missing in time: loss, delay (held until the next), or ignore.")
]


def _load(file: Path, format: str, unit: str, column: str, period: float, kind: str, gap: str) -> "Trace":
    from farhand.netem.recordings.trace import load_trace

    return load_trace(
        file,
        format=format or None,
        unit=unit or None,
        column=column or None,
        period=period / 1000 if period else None,
        kind=cast("Kind", kind) if kind else None,
        gap=cast("Gap", gap),
    )


@trace_app.command()
def show(
    file: FileArgument,
    format: FormatOption = "",
    unit: UnitOption = "",
    column: ColumnOption = "",
    period: PeriodOption = 0.0,
    kind: KindOption = "",
    gap: GapOption = "loss",
    figure: Annotated[str, typer.Option("--figure", "--out", help="Write a figure (PNG, SVG or PDF).")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON (s) instead of tables.")] = False,
) -> None:
    """Percentiles, loss and autocorrelation of a trace, and a figure of it."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from farhand.netem.recordings.autocorrelation import autocorrelation
    from farhand.netem.recordings.delay_figure import draw_trace
    from farhand.netem.recordings.trace import QUANTILES

    trace = _load(file, format, unit, column, period, kind, gap)
    summary = trace.summary()
    correlation = autocorrelation(trace.recorded)
    if figure:
        draw_trace(trace, figure, file.name)
    if as_json:
        known = {str(lag): value for lag, value in correlation.items() if value == value}
        typer.echo(json.dumps({**summary, "autocorrelation": known}))
        return
    console = Console()
    span = "no times" if trace.duration is None else f"{trace.duration:.1f} s"
    loss = 100 * cast(float, summary["loss"])
    console.print(
        escape(f"{file.name}: {trace.kind}, {trace.provenance or 'source unknown'}"), highlight=False
    )
    console.print(
        f"{summary['samples']} samples, {span}, {summary['lost']} lost ({loss:.2f} %)", highlight=False
    )
    table = Table(title="delay, ms", title_justify="left")
    for name in ("mean", "std", *QUANTILES):
        table.add_column(name, justify="right")
    table.add_row(*(_milliseconds(summary[name]) for name in ("mean", "std", *QUANTILES)))
    console.print(table)
    lags = Table(title="autocorrelation, by the distance in samples", title_justify="left")
    for lag in correlation:
        lags.add_column(str(lag), justify="right")
    lags.add_row(*("-" if value != value else f"{value:.3f}" for value in correlation.values()))
    console.print(lags)
    if figure:
        console.print(f"figure: {figure}", highlight=False)


@trace_app.command("record")
def record_command(
    connect: Annotated[
        list[str] | None, typer.Option("--connect", help="The reflector's endpoint: measure.")
    ] = None,
    listen: Annotated[list[str] | None, typer.Option("--listen", help="Be the reflector, here.")] = None,
    rate: Annotated[float, typer.Option(help="Messages per second.")] = 50.0,
    size: Annotated[int, typer.Option(help="Bytes of each message.")] = 300,
    seconds: Annotated[
        float, typer.Option(help="How long to send (0: 20 s), or to reflect (0: always).")
    ] = 0.0,
    wait: Annotated[float, typer.Option(help="How long to wait for the last echoes, in s.")] = 2.0,
    out: Annotated[str, typer.Option(help="The trace to write (CSV).")] = "trace.csv",
) -> None:
    """Measure a real path by echo.

    On the one host: `farhand trace record --listen tcp/0.0.0.0:7450`. On the other:
    `farhand trace record --connect tcp/FIRST:7450 --rate 50 --size 300 --seconds 20 --out path.csv`.
    """
    from farhand.common.timing.clock import SystemClock
    from farhand.netem.main import stop_on_signals
    from farhand.netem.recordings.record import RecordSettings, Reflector, record
    from farhand.netem.recordings.write import write_trace

    stop = stop_on_signals()
    if not connect:
        if not listen:
            raise InputError("give --listen on the one host, and --connect with its endpoint on the other")
        reflector = Reflector(listen=listen)
        try:
            typer.echo(f"reflecting on {', '.join(listen)}; end with Ctrl-C")
            stop.wait(seconds if seconds > 0 else None)
        finally:
            reflector.close()
        typer.echo(f"reflected {reflector.reflected} messages")
        return
    settings = RecordSettings(
        tuple(connect), tuple(listen or ()), rate_hz=rate, size=size, duration=seconds or 20.0, wait=wait
    )
    trace = record(settings, SystemClock(), stop)
    write_trace(trace, out)
    summary = trace.summary()
    typer.echo(
        f"{out}: {summary['samples']} sent, {summary['lost']} lost, RTT p50 {_milliseconds(summary['p50'])} "
        f"p99 {_milliseconds(summary['p99'])} max {_milliseconds(summary['max'])} ms"
    )


@trace_app.command()
def fit(
    file: FileArgument,
    format: FormatOption = "",
    unit: UnitOption = "",
    column: ColumnOption = "",
    period: PeriodOption = 0.0,
    kind: KindOption = "",
    gap: GapOption = "loss",
    out: Annotated[str, typer.Option(help="Write the model (TOML), for --network model:FILE.")] = "",
    seed: Annotated[int, typer.Option(help="Seed of the draws that are compared.")] = 0,
) -> None:
    """Fit a seeded model (jitter, slow or held episodes, outages, loss) and compare it with the recording."""
    if seed < 0:
        raise InputError(f"--seed {seed}: must not be negative")
    from rich.console import Console
    from rich.table import Table

    from farhand.common.seeds import stream
    from farhand.netem.models.fit import fit_model, model_quantiles, save_model
    from farhand.netem.recordings.trace import QUANTILES

    trace = _load(file, format, unit, column, period, kind, gap)
    model = fit_model(trace)
    step = (trace.duration or 0.0) / len(trace.recorded)
    wanted = trace.summary()
    fitted = model_quantiles(
        model, tuple(QUANTILES.values()), lambda direction: stream(seed, "trace-fit", direction), step
    )
    if out:
        save_model(model, out, f"fitted to {file.name}: {trace.provenance or 'source unknown'}")
    console = Console()
    table = Table(title="recorded and fitted delays, ms", title_justify="left")
    table.add_column("")
    for name in QUANTILES:
        table.add_column(name, justify="right")
    table.add_row("recorded", *(_milliseconds(wanted[name]) for name in QUANTILES))
    table.add_row("fitted", *(_milliseconds(fitted[percent]) for percent in QUANTILES.values()))
    console.print(table)
    for line in _describe(model):
        console.print(line, highlight=False)
    if out:
        console.print(f"use it as: --network model:{out}", highlight=False)


@trace_app.command()
def convert(
    file: Annotated[Path, typer.Argument(help="The trace to read.", metavar="IN")],
    target: Annotated[Path, typer.Argument(help="The file to write.", metavar="OUT")],
    to: Annotated[str, typer.Option(help="csv or slots.")] = "csv",
    to_unit: Annotated[str, typer.Option(help="Unit to write.")] = "ms",
    slot: Annotated[float, typer.Option(help="Length of the slots to write, in ms.")] = 0.0,
    format: FormatOption = "",
    unit: UnitOption = "",
    column: ColumnOption = "",
    period: PeriodOption = 0.0,
    kind: KindOption = "",
    gap: GapOption = "loss",
) -> None:
    """Write a trace in another format."""
    from farhand.netem.recordings.write import write_trace

    trace = _load(file, format, unit, column, period, kind, gap)
    write_trace(trace, target, to, unit=to_unit, period=slot / 1000 if slot else None)
    typer.echo(f"{target}: {len(trace.recorded)} samples read, written as {to}")


def _milliseconds(value: float | int | str | None) -> str:
    return f"{float(value) * 1e3:.4g}" if isinstance(value, float | int) else "-"


def _describe(model: "DelayModel") -> list[str]:
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


def _rounded(jitter: object) -> dict[str, float]:
    fields = ("shape", "scale", "width", "correlation_time")
    return {name: float(f"{getattr(jitter, name):.4g}") for name in fields if hasattr(jitter, name)}
