"""Draws the figures of docs/netem.md from the emulator itself: `python docs/figures/netem_figures.py`."""

import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from farhand.common.link.link import Packet
from farhand.netem.chain import build_chain
from farhand.netem.spec import parse_spec

HERE = Path(__file__).resolve().parent
BLUE, ORANGE = "#0072B2", "#D55E00"
WIDTH = 7.16
KEY = "farhand/r/state"


def offer(spec, count, interval_ms, size=300):
    """Arrivals (ms), releases (ms, NaN: dropped) and the transits of one key's messages."""
    chain = build_chain(parse_spec(spec), 1, "downlink")
    transits = []
    for n in range(count):
        now_ns = round(n * interval_ms * 1e6) + 1
        transits.extend(chain.offer(Packet(KEY, b"\x00" * size, now_ns), now_ns))
    arrived = np.array([t.arrived_ns / 1e6 for t in transits])
    released = np.array([np.nan if t.cause else t.release_ns / 1e6 for t in transits])
    return arrived, released, transits


def distributions(folder):
    """Histograms of 20,000 draws of each distribution."""
    table = Path(folder) / "slots.txt"
    rng = np.random.default_rng(1)
    both = np.concatenate([rng.normal(30, 3, 400), rng.normal(90, 10, 200)])
    table.write_text("".join(f"{value:.3f}\n" for value in both), encoding="utf-8")
    words = {
        "constant:50": "constant:50",
        "uniform:20,80": "uniform:20,80",
        "gaussian:50,20": "gaussian:50,20",
        "pareto:50,20": "pareto:50,20",
        "paretonormal:50,20": "paretonormal:50,20",
        "lognormal:50,20": "lognormal:50,20",
        "empirical:FILE": f"empirical:{table},period=10,kind=one-way",
        "lund-stockholm": "lund-stockholm",
    }
    figure, axes = plt.subplots(2, 4, figsize=(WIDTH, 2.7), sharex=True)
    for axis, (title, spec) in zip(axes.flat, words.items(), strict=True):
        arrived, released, _ = offer(spec, 20_000, 10)
        axis.hist(released - arrived, bins=np.arange(0, 152, 2), color=BLUE, density=True)
        axis.set_title(title)
        axis.set_yticks([])
    for axis in axes[1]:
        axis.set_xlabel("delay (ms)")
    axes[0, 0].set_xlim(0, 150)
    return figure


def timelines(folder):
    """Delay of each message over its arrival."""
    rate = Path(folder) / "link.up"
    rate.write_text(
        "".join(f"{n}\n" for n in [*range(2, 300, 4), *range(300, 700, 40), *range(700, 1000, 4)])
    )
    panels = [
        ("gaussian:50,20", 200, 5, 300),
        ("gaussian:50,20,95%", 200, 5, 300),
        ("gaussian:50,20 reorder:in-order", 200, 5, 300),
        ("constant:50 reorder:gap(5)", 60, 16, 300),
        ("constant:20 loss:10%", 200, 5, 300),
        ("constant:20 loss:gilbert(2%,20%)", 200, 5, 300),
        ("constant:20 loss:state(2%,20%,20%,40%)", 200, 5, 300),
        ("constant:20 duplicate:10% gaussian", 200, 5, 300),
        ("rate:400kbit,8kB", 200, 5, 300),
        ("rate:trace(FILE)", 200, 5, 300),
        ("slot:100", 200, 5, 300),
        ("constant:20 outage:at(300ms,200ms)", 200, 5, 300),
        ("constant:20 outage:at(300ms,200ms,hold)", 200, 5, 300),
        ("constant:20 loss:5% tcp-like:100", 200, 5, 300),
        ("constant:20 corrupt:10%", 200, 5, 300),
    ]
    figure, axes = plt.subplots(5, 3, figsize=(WIDTH, 6.4), sharex=True)
    for axis, (title, count, interval, size) in zip(axes.flat, panels, strict=True):
        spec = title.replace("FILE", str(rate))
        if "duplicate" in title:
            title = spec = "gaussian:20,4 duplicate:10%"
        arrived, released, transits = offer(spec, count, interval, size)
        delay = released - arrived
        marked = np.array([t.is_copy or t.corrupted for t in transits])
        axis.plot(arrived, delay, ".", color=BLUE, markersize=2.5)
        axis.plot(arrived[marked], delay[marked], "x", color=ORANGE, markersize=4)
        lost = np.isnan(delay)
        axis.plot(arrived[lost], np.zeros(lost.sum()), "|", color=ORANGE, markersize=5)
        top = max(30.0, 1.15 * np.nanmax(delay))
        axis.set_ylim(-0.08 * top, top)
        axis.set_title(title)
    for axis in axes[-1]:
        axis.set_xlabel("arrival (ms)")
    for axis in axes[:, 0]:
        axis.set_ylabel("delay (ms)")
    return figure


def main():
    """Draw both figures beside this file."""
    plt.switch_backend("Agg")
    plt.rcParams.update({"font.family": "serif", "font.size": 8, "axes.titlesize": 7, "axes.linewidth": 0.6})
    with tempfile.TemporaryDirectory() as folder:
        for name, draw in (("netem_distributions", distributions), ("netem_timelines", timelines)):
            figure = draw(folder)
            figure.tight_layout(pad=0.4)
            figure.savefig(HERE / f"{name}.png", dpi=150)
            plt.close(figure)


if __name__ == "__main__":
    main()
