"""A figure of a trace: its delays over time, and their tail."""

from pathlib import Path
from typing import Any

import numpy as np

from farhand.common.errors import TraceError
from farhand.netem.recordings.trace import Trace

WIDTH = 7.16
_BLUE, _ORANGE = "#0072B2", "#D55E00"
_STYLE: Any = {
    "font.family": "serif",
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
}


def draw_trace(trace: Trace, path: str | Path, title: str) -> None:
    """Write a figure of the delays over time and their complementary distribution (PNG, SVG or PDF).

    Raises TraceError if the file cannot be written.
    """
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullLocator

    times, label = trace.times, "message" if trace.duration is None else "time (s)"
    if times is None:
        times = np.arange(len(trace.recorded), dtype=np.float64) * (trace.period or 1.0)
    lost = np.isnan(trace.recorded)
    arrived = np.sort(trace.recorded[~lost]) * 1e3
    unit = "RTT (ms)" if trace.kind == "round-trip" else "one-way delay (ms)"
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(WIDTH, 2.4), layout="constrained")
        FigureCanvasAgg(figure)
        over_time, tail = figure.subplots(1, 2, width_ratios=(2, 1))
        over_time.plot(times, trace.recorded * 1e3, color=_BLUE, linewidth=0.6, marker=",")
        floor = float(arrived[0])
        over_time.set_yscale("log")
        if lost.any():
            share = 100 * lost.mean()
            over_time.plot(
                times[lost],
                np.full(int(lost.sum()), floor * 0.85),
                "|",
                color=_ORANGE,
                markersize=5,
                label=f"lost ({share:.2g} %)",
            )
            over_time.legend(loc="upper right", frameon=False)
        over_time.set_xlabel(label)
        over_time.set_ylabel(unit)
        over_time.set_title(title, loc="left")
        above = 1.0 - np.arange(len(arrived)) / len(arrived)
        tail.step(arrived, above, where="post", color=_BLUE, linewidth=1)
        for percent in (50, 99):
            value = float(np.percentile(arrived, percent))
            tail.plot(value, 1 - percent / 100, "o", color=_ORANGE, markersize=3)
            tail.annotate(
                f"p{percent} {value:.3g} ms",
                (value, 1 - percent / 100),
                xytext=(4, 3),
                textcoords="offset points",
            )
        tail.set_xscale("log")
        tail.set_yscale("log")
        tail.set_xlabel(unit)
        tail.set_ylabel("fraction above")
        for axes in (over_time.yaxis, tail.xaxis):
            axes.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.set_major_formatter("{x:g}")
            axes.set_minor_locator(NullLocator())
        try:
            figure.savefig(str(path), dpi=200)
        except (OSError, ValueError) as error:
            raise TraceError(f"figure {path}: cannot be written: {' '.join(str(error).split())}") from None
