"""`farhand trace`: look at recorded delays, record them, fit a model to them, convert them."""

import dataclasses
import json
import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from farhand.common.errors import InputError

if TYPE_CHECKING:
    from farhand.netem.recordings.formats.base import Decimal, Kind
    from farhand.netem.recordings.gaps import Gap
    from farhand.netem.recordings.trace import Trace

trace_app = typer.Typer(
    help="Recorded network delays: show, record, fit a model, convert.", no_args_is_help=True
)

FileArgument = Annotated[Path, typer.Argument(help="The trace.", metavar="FILE")]
FormatOption = Annotated[
    str, typer.Option("--format", help="Name of the format, such as ping (default: by the content).")
]
UnitOption = Annotated[str, typer.Option("--unit", metavar="s | ms | us | ns", help="Unit of the delays.")]
ColumnOption = Annotated[str, typer.Option("--column", help="The delay's column: its name, or 1, 2, ...")]
PeriodOption = Annotated[
    float, typer.Option("--period", help="Length of a slot, in ms (default: the file's own).")
]
KindOption = Annotated[str, typer.Option("--kind", metavar="one-way | round-trip", help="Of the delays.")]
GapOption = Annotated[
    str,
    typer.Option(
        "--gap",
        metavar="auto | loss | delay | ignore",
        help="Rows missing in time: judged, lost, held until the next, or no matter.",
    ),
]
TimeUnitOption = Annotated[
    str, typer.Option("--time-unit", metavar="s | ms | us | ns", help="Unit of the times.")
]
DecimalOption = Annotated[
    str, typer.Option("--decimal", metavar="comma | point", help="Where 1,234 can be either.")
]
LostOption = Annotated[
    str, typer.Option("--lost", help="How the file writes a lost message, such as 0; none: a 0 is a delay.")
]
SortOption = Annotated[bool, typer.Option("--sort", help="Put rows in order that are not.")]


def _load(
    file: Path,
    format: str,
    unit: str,
    column: str,
    period: float,
    kind: str,
    gap: str,
    time_unit: str,
    decimal: str,
    lost: str,
    sort: bool,
) -> "Trace":
    from farhand.netem.recordings.trace import load_trace

    return load_trace(
        file,
        format=format or None,
        unit=unit or None,
        column=column or None,
        period=period / 1000 if period else None,
        kind=cast("Kind", kind) if kind else None,
        gap=cast("Gap", gap),
        time_unit=time_unit or None,
        decimal=cast("Decimal", decimal) if decimal else None,
        lost=lost or None,
        sort=sort,
    )


@trace_app.command()
def show(
    file: FileArgument,
    format: FormatOption = "",
    unit: UnitOption = "",
    column: ColumnOption = "",
    period: PeriodOption = 0.0,
    kind: KindOption = "",
    gap: GapOption = "auto",
    time_unit: TimeUnitOption = "",
    decimal: DecimalOption = "",
    lost: LostOption = "",
    sort: SortOption = False,
    figure: Annotated[str, typer.Option("--figure", "--out", help="Write a figure (PNG, SVG or PDF).")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON (s) instead of tables.")] = False,
) -> None:
    """Percentiles, loss and autocorrelation of a trace, and a figure of it."""
    from farhand.commands.emulation.trace_tables import print_trace
    from farhand.netem.recordings.autocorrelation import autocorrelation
    from farhand.netem.recordings.delay_figure import draw_trace

    trace = _load(file, format, unit, column, period, kind, gap, time_unit, decimal, lost, sort)
    summary = trace.summary()
    correlation = autocorrelation(trace.recorded)
    if figure:
        draw_trace(trace, figure, file.name)
    if as_json:
        known = {str(lag): value for lag, value in correlation.items() if value == value}
        reading = dataclasses.asdict(trace.reading)
        typer.echo(json.dumps({**summary, "autocorrelation": known, "reading": reading}))
        return
    print_trace(trace, file.name, summary, correlation)
    if figure:
        typer.echo(f"figure: {figure}")


@trace_app.command("record")
def record_command(
    connect: Annotated[
        list[str] | None, typer.Option("--connect", help="The reflector's endpoint: measure.")
    ] = None,
    listen: Annotated[list[str] | None, typer.Option("--listen", help="Be the reflector, here.")] = None,
    rate: Annotated[float, typer.Option(help="Messages per second.")] = 50.0,
    size: Annotated[int, typer.Option(help="Bytes of each message.")] = 300,
    seconds: Annotated[
        float, typer.Option(help="How long to send, in s (default: 20), or to reflect (default: always).")
    ] = 0.0,
    wait: Annotated[float, typer.Option(help="How long to wait for the last echoes, in s.")] = 2.0,
    out: Annotated[str, typer.Option(help="The trace to write (CSV).")] = "trace.csv",
) -> None:
    """Measure a real path by echo.

    On the one host: `farhand trace record --listen tcp/0.0.0.0:7450`. On the other:
    `farhand trace record --connect tcp/FIRST:7450 --rate 50 --size 300 --seconds 20 --out path.csv`.
    """
    from farhand.commands.emulation.trace_tables import in_ms
    from farhand.common.process.outputs import check_writable
    from farhand.common.process.signals import stop_event_on_signals
    from farhand.common.timing.clock import SystemClock
    from farhand.netem.recordings.record import RecordSettings, Reflector, record
    from farhand.netem.recordings.write import write_trace

    stop = stop_event_on_signals()
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
    check_writable(out, "--out")
    settings = RecordSettings(
        tuple(connect), tuple(listen or ()), rate_hz=rate, size=size, duration=seconds or 20.0, wait=wait
    )
    trace = record(settings, SystemClock(), stop)
    write_trace(trace, out)
    summary = trace.summary()
    typer.echo(
        f"{out}: {summary['samples']} sent, {summary['lost']} lost, RTT p50 {in_ms(summary['p50'])} "
        f"p99 {in_ms(summary['p99'])} max {in_ms(summary['max'])} ms"
    )


@trace_app.command()
def fit(
    file: FileArgument,
    format: FormatOption = "",
    unit: UnitOption = "",
    column: ColumnOption = "",
    period: PeriodOption = 0.0,
    kind: KindOption = "",
    gap: GapOption = "auto",
    time_unit: TimeUnitOption = "",
    decimal: DecimalOption = "",
    lost: LostOption = "",
    sort: SortOption = False,
    out: Annotated[str, typer.Option(help="Write the model (TOML), for --network model:FILE.")] = "",
    seed: Annotated[int, typer.Option(help="Seed of the draws that are compared.")] = 0,
) -> None:
    """Fit a seeded model (jitter, slow or held episodes, outages, loss) and compare it with the recording."""
    if seed < 0:
        raise InputError(f"--seed {seed}: must not be negative")
    from farhand.commands.emulation.trace_tables import print_fit, print_reading
    from farhand.common.seeds import stream
    from farhand.netem.models.fit import fit_model, model_quantiles, save_model
    from farhand.netem.recordings.trace import QUANTILES

    trace = _load(file, format, unit, column, period, kind, gap, time_unit, decimal, lost, sort)
    print_reading(trace)
    model = fit_model(trace)
    step = (trace.duration or 0.0) / len(trace.recorded)
    wanted = trace.summary()
    fitted, fitted_loss = model_quantiles(
        model, tuple(QUANTILES.values()), lambda direction: stream(seed, "trace-fit", direction), step
    )
    if out:
        save_model(model, out, f"fitted to {file.name}: {trace.provenance or 'source unknown'}")
    print_fit(model, wanted, fitted, fitted_loss)
    if out:
        typer.echo(f"use it as: --network {as_word(str(out))}")


def as_word(path: str) -> str:
    """How a shell hands a model's file to --network: in quotes of the word's own where it is more than a plain name."""
    if re.fullmatch(r"[\w./+-]+", path):
        return f"model:{path}"
    return shlex.quote(f'model:"{path}"')


@trace_app.command()
def convert(
    file: Annotated[Path, typer.Argument(help="The trace to read.", metavar="IN")],
    target: Annotated[Path, typer.Argument(help="The file to write.", metavar="OUT")],
    to: Annotated[str, typer.Option(metavar="csv | slots", help="The format to write.")] = "csv",
    to_unit: Annotated[str, typer.Option(metavar="s | ms | us | ns", help="Unit to write.")] = "ms",
    slot: Annotated[
        float, typer.Option(help="Length of the slots to write, in ms (default: the trace's own).")
    ] = 0.0,
    format: FormatOption = "",
    unit: UnitOption = "",
    column: ColumnOption = "",
    period: PeriodOption = 0.0,
    kind: KindOption = "",
    gap: GapOption = "auto",
    time_unit: TimeUnitOption = "",
    decimal: DecimalOption = "",
    lost: LostOption = "",
    sort: SortOption = False,
) -> None:
    """Write a trace in another format."""
    from farhand.commands.emulation.trace_tables import print_reading
    from farhand.netem.recordings.write import write_trace

    trace = _load(file, format, unit, column, period, kind, gap, time_unit, decimal, lost, sort)
    print_reading(trace)
    write_trace(trace, target, to, unit=to_unit, period=slot / 1000 if slot else None)
    typer.echo(f"{target}: {len(trace.recorded)} samples read, written as {to}")
