"""The emulator's statistics as a table for people."""

from rich.console import Console
from rich.table import Table

from farhand.common.process.console import whole
from farhand.netem.measure.result import Delays, NetemResult


def fine_milliseconds(seconds: float) -> str:
    """A duration in ms with three digits behind the point."""
    return f"{seconds * 1000:.3f}"


def statistics_table(statistics: NetemResult) -> Table:
    """What the emulator did, both directions side by side."""
    table = Table(title="netem", title_justify="left")
    table.add_column("")
    for name in statistics.directions:
        table.add_column(name, justify="right", overflow="fold")
    both = tuple(statistics.directions.values())

    def row(label: str, *values: object) -> None:
        table.add_row(label, *map(str, values))

    row("network", *(d.spec for d in both))
    for name in ("received", "delivered", "duplicated", "corrupted", "reordered", "retransmitted", "queued"):
        counts = [getattr(d, name) for d in both]
        if name in ("received", "delivered") or any(counts):
            row(name, *counts)
    for cause in sorted({cause for d in both for cause in d.dropped}):
        row(f"dropped: {cause}", *(d.dropped.get(cause, 0) for d in both))
    if any(d.below_zero for d in both):
        row("drawn below zero", *(d.below_zero for d in both))
    for name, delays in (("drawn", [d.drawn for d in both]), ("achieved", [d.achieved for d in both])):
        row(f"{name}, mean ± sd (ms)", *map(_mean, delays))
        row(f"{name}, p50 / p99 (ms)", *map(_quantiles, delays))
    row(
        "error, p50 / p99 / max (ms)",
        *(f"{_quantiles(d.error)} / {fine_milliseconds(d.error.max)}" for d in both),
    )
    if statistics.rtt.count:
        table.add_section()
        row("RTT from echoes, mean ± sd (ms)", _mean(statistics.rtt), "")
        row("RTT, p50 / p99 (ms)", _quantiles(statistics.rtt), "")
    if statistics.bypassed or statistics.both_sides:
        row("went past the emulator", statistics.bypassed, len(statistics.both_sides))
    row("every message accounted for", "yes" if statistics.conserved else "NO", "")
    return table


def _mean(delays: Delays) -> str:
    return f"{fine_milliseconds(delays.mean)} ± {fine_milliseconds(delays.std)}"


def _quantiles(delays: Delays) -> str:
    return f"{fine_milliseconds(delays.p50)} / {fine_milliseconds(delays.p99)}"


def print_statistics(statistics: NetemResult, console: Console) -> None:
    """The table of both directions and, where robots have networks of their own or are several, one of robots."""
    console.print(whole(statistics_table(statistics), console))
    names = {name for way in statistics.directions.values() for name in way.robots}
    own = {name for way in statistics.directions.values() for name in way.robot_specs}
    if own or len(names - {"other", "netem"}) > 1:
        console.print(whole(robots_table(statistics, sorted(names | own)), console))


def robots_table(statistics: NetemResult, names: list[str]) -> Table:
    """Each robot's network and what became of its messages, a row a direction."""
    table = Table(title="robots", title_justify="left")
    table.add_column("robot", overflow="fold")
    table.add_column("network", overflow="fold")
    for name in ("received", "dropped", "p50 / p99 (ms)", "RTT (ms)"):
        table.add_column(name, justify="right")
    for name in names:
        rtt = statistics.rtt_by_robot.get(name)
        for sign, way in (("up", statistics.uplink), ("down", statistics.downlink)):
            found, own = way.robots.get(name), way.robot_specs.get(name)
            network = f"{sign}: {way.spec + ' (common)' if own is None else own}"
            counts = ["0", "0", ""]
            if found is not None:
                delays = f"{found.achieved.p50 * 1000:.1f} / {found.achieved.p99 * 1000:.1f}"
                counts = [str(found.received), str(sum(found.dropped.values())), delays]
            first = sign == "up"
            trips = f"{rtt.p50 * 1000:.1f}" if rtt is not None and rtt.count and first else ""
            table.add_row(name if first else "", network, *counts, trips)
    return table
