"""The emulator's statistics as a table for people."""

from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table


def milliseconds(seconds: float) -> str:
    """A duration in ms with three digits behind the point."""
    return f"{seconds * 1000:.3f}"


def statistics_table(statistics: dict[str, Any]) -> Table:
    """What `NetemNode.statistics` gave, both directions side by side."""
    table = Table(title="netem", title_justify="left")
    table.add_column("")
    for name in ("uplink", "downlink"):
        table.add_column(name, justify="right", overflow="fold")
    both = [statistics["uplink"], statistics["downlink"]]

    def row(label: str, *values: object) -> None:
        table.add_row(label, *(escape(str(value)) for value in values))

    row("network", *(d["spec"] for d in both))
    for name in ("received", "delivered", "duplicated", "corrupted", "reordered", "retransmitted", "queued"):
        if name in ("received", "delivered") or any(d[name] for d in both):
            row(name, *(d[name] for d in both))
    for cause in sorted({cause for d in both for cause in d["dropped"]}):
        row(f"dropped: {cause}", *(d["dropped"].get(cause, 0) for d in both))
    if any(d["below_zero"] for d in both):
        row("drawn below zero", *(d["below_zero"] for d in both))
    for name in ("drawn", "achieved"):
        row(
            f"{name}, mean ± sd (ms)",
            *(f"{milliseconds(d[name]['mean'])} ± {milliseconds(d[name]['std'])}" for d in both),
        )
        row(
            f"{name}, p50 / p99 (ms)",
            *(f"{milliseconds(d[name]['p50'])} / {milliseconds(d[name]['p99'])}" for d in both),
        )
    row(
        "error, p50 / p99 / max (ms)",
        *(" / ".join(milliseconds(d["error"][q]) for q in ("p50", "p99", "max")) for d in both),
    )
    rtt = statistics["rtt"]
    if rtt["count"]:
        table.add_section()
        row(
            "RTT from echoes, mean ± sd (ms)", f"{milliseconds(rtt['mean'])} ± {milliseconds(rtt['std'])}", ""
        )
        row("RTT, p50 / p99 (ms)", f"{milliseconds(rtt['p50'])} / {milliseconds(rtt['p99'])}", "")
    if statistics["bypassed"] or statistics.get("both_sides"):
        row("went past the emulator", statistics["bypassed"], len(statistics.get("both_sides", [])))
    row("every message accounted for", "yes" if statistics["conserved"] else "NO", "")
    return table


def print_statistics(statistics: dict[str, Any], console: Console) -> None:
    """The table of both directions and, where robots have networks of their own or are several, one of robots."""
    console.print(statistics_table(statistics))
    names = {name for way in ("uplink", "downlink") for name in statistics[way]["robots"]}
    own = {name for way in ("uplink", "downlink") for name in statistics[way]["robot_specs"]}
    if own or len(names - {"other", "netem"}) > 1:
        console.print(robots_table(statistics, sorted(names | own)))


def robots_table(statistics: dict[str, Any], names: list[str]) -> Table:
    """Each robot's network and what became of its messages, a row a direction."""
    table = Table(title="robots", title_justify="left")
    table.add_column("robot", overflow="fold")
    table.add_column("network", overflow="fold")
    for name in ("received", "dropped", "p50 / p99 (ms)", "RTT (ms)"):
        table.add_column(name, justify="right")
    for name in names:
        rtt = statistics["rtt_by_robot"].get(name)
        for way, sign in (("uplink", "up"), ("downlink", "down")):
            found, own = statistics[way]["robots"].get(name), statistics[way]["robot_specs"].get(name)
            network = f"{sign}: {statistics[way]['spec'] + ' (common)' if own is None else own}"
            counts = ["0", "0", ""]
            if found is not None:
                delays = " / ".join(f"{found['achieved'][q] * 1000:.1f}" for q in ("p50", "p99"))
                counts = [str(found["received"]), str(sum(found["dropped"].values())), delays]
            trips = f"{rtt['p50'] * 1000:.1f}" if rtt is not None and rtt["count"] and way == "uplink" else ""
            table.add_row(escape(name) if way == "uplink" else "", escape(network), *counts, trips)
    return table
