"""What `farhand netem check` found, as a table for people."""

from typing import Any

from rich.table import Table

from farhand.netem.measure.report import fine_milliseconds


def check_table(found: dict[str, Any]) -> Table:
    """Both directions side by side: drawn, achieved, error, and the judgements."""
    priority = "SCHED_FIFO" if found["realtime_priority"] else "plain scheduling"
    table = Table(
        title=f"netem check: {found['rate_hz']:g} messages/s of {found['size']} bytes each way for "
        f"{found['seconds']:g} s, seed {found['seed']}, {priority}",
        title_justify="left",
    )
    table.add_column("")
    both = [found["uplink"], found["downlink"]]
    for name in ("uplink", "downlink"):
        table.add_column(name, justify="right", overflow="fold")

    def row(label: str, *values: object) -> None:
        table.add_row(label, *map(str, values))

    def quantities(values: dict[str, float], *names: str) -> str:
        return " / ".join(fine_milliseconds(values[name]) for name in names)

    row("network", *(d["spec"] for d in both))
    row("sent / taken in", *(f"{d['sent']} / {d['taken_in']}" for d in both))
    row("lost as drawn", *(", ".join(f"{c} {n}" for c, n in d["lost_as_drawn"].items()) or "0" for d in both))
    row("duplicated", *(d["duplicated"] for d in both))
    row("delivered / arrived", *(f"{d['delivered']} / {d['arrived']}" for d in both))
    row(
        "reordered as drawn / on arrival",
        *(f"{d['reordered_as_drawn']} / {d['reordered_on_arrival']}" for d in both),
    )
    table.add_section()
    for name in ("drawn", "assigned", "achieved"):
        row(f"{name}, mean / sd (ms)", *(quantities(d[name], "mean", "std") for d in both))
        row(f"{name}, p50 / p99 (ms)", *(quantities(d[name], "p50", "p99") for d in both))
    row("error, median / p99 / max (ms)", *(quantities(d["error"], "p50", "p99", "max") for d in both))
    row("Toxiproxy's own tests accept (ms)", "± 10", "± 10")
    table.add_section()
    row(
        "Kolmogorov-Smirnov against another seed",
        *(
            f"D = {d['ks']['statistic']:.4f}, p = {d['ks']['p']:.3f}" if "ks" in d else "too few"
            for d in both
        ),
    )
    row("same seed in virtual time: same fates, delays", *("yes" if d["replays"] else "NO" for d in both))
    row(
        "every message accounted for",
        *("yes" if d["accounted"] and found["conserved"] else "NO" for d in both),
    )
    return table
