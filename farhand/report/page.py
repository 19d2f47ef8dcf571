"""The report as one HTML file that needs nothing else."""

import json
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

import numpy as np

from farhand.common.geometry import Array
from farhand.report import rows, tables, words
from farhand.report.drawing import charts, marks, space
from farhand.report.drawing.svg import Chart, drawn, legend
from farhand.report.reading.evidence import Evidence
from farhand.report.reading.figures import Figures, figures_of
from farhand.report.reading.story import Story

HERE = Path(__file__).parent


class Page:
    """Args:
    runs: one, or two that are set side by side.
    """

    def __init__(self, runs: Sequence[Evidence]) -> None:
        self._runs = runs
        self._figures = [figures_of(each) for each in runs]
        self._told = [tables.told(each) for each in self._figures]
        times = [t for each in runs if len(t := each.story.ticks["t"])]
        begin = min((float(t[0]) for t in times), default=0.0)
        end = max((float(t[-1]) for t in times), default=0.0)
        self._span = (begin, end if end > begin else begin + 1.0)

    def html(self) -> str:
        """The file."""
        title = " and ".join(f"{each.scenario} over {words.network(each)}" for each in self._figures)
        style = (HERE / "page.css").read_text(encoding="utf-8")
        script = (HERE / "turning.js").read_text(encoding="utf-8")
        icon = '<link rel="icon" href="data:,">'
        return (
            '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">{icon}'
            f"<title>{escape(title)}</title>\n<style>\n{style}</style></head>\n<body>\n"
            + "\n".join(self._sections())
            + f"\n<script>\n{script}</script>\n</body></html>\n"
        )

    def _sections(self) -> list[str]:
        runs, found = self._runs, self._figures
        out = [self._panels(lambda k: _head(found[k], several=len(runs) > 1))]
        out += [
            marks.definition(_marks(k), marks.bands(each.story, self._span)) for k, each in enumerate(runs)
        ]
        out.append(_section("In figures", tables.figures(found, rows.SAFETY) + self._guard()))
        if len(runs) == 2:
            out.append(_section("Where they differ", tables.differences(runs[0], runs[1])))
        out.append(self._space())
        out += self._over_time()
        out.append(
            _section(
                "What happened",
                self._panels(lambda k: tables.events(found[k], self._told[k], _event(k))),
            )
        )
        out.append(self._timing())
        out.append(
            _section("Settings that are not the defaults", self._panels(lambda k: tables.changed(found[k])))
        )
        out.append(_section("What ran", self._panels(lambda k: _versions(found[k]))))
        return out

    def _panels(self, tell: Callable[[int], str]) -> str:
        inner = "".join(f"<div>{tell(k)}</div>" for k in range(len(self._runs)))
        return f'<div class="runs{" two" if len(self._runs) > 1 else ""}">{inner}</div>'

    def _guard(self) -> str:
        lines = [tables.guard_line(each) for each in self._runs]
        names = [f" of {each.name}" if len(self._runs) > 1 else "" for each in self._runs]
        return self._panels(
            lambda k: f'<p class="said">guard{escape(names[k])}: {escape(lines[k])}</p>' if lines[k] else ""
        )

    def _space(self) -> str:
        spaces = [space.space_of(each.story) for each in self._runs]
        if not any(len(each.path) for each in spaces):
            return _section("Path", "<p>No state of the robot is in the recording: there is no path.</p>")
        boxes = np.array([each.corners for each in spaces])
        corners = np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
        return _section("Path of the tool", self._panels(lambda k: _path(spaces[k], corners, k)))

    def _over_time(self) -> list[str]:
        found = self._figures
        return [
            self._charted("Clearance", charts.clearance, _ABOUT_CLEARANCE, strip=True),
            self._charted("Margin", charts.margin, _ABOUT_MARGIN) + tables.figures(found, rows.MARGIN),
            self._charted("Speed", charts.speed, "Of the tool, before and after the filter."),
            self._charted("Turning", charts.turning, ""),
            self._charted("Network", charts.round_trip, ""),
            self._charted("", charts.loss, "") + tables.figures(found, rows.LINK),
        ]

    def _timing(self) -> str:
        chart = self._charted("Timing", lambda story, _: charts.timing(story), _ABOUT_TIMING)
        table = tables.figures(self._figures, rows.TIMING)
        return chart + table if chart else _section("Timing", table)

    def _charted(
        self, title: str, make: Callable[[Story, str], Chart | None], about: str, *, strip: bool = False
    ) -> str:
        made = [make(each.story, _marks(k)) for k, each in enumerate(self._runs)]
        there = [each for each in made if each is not None]
        if not there:
            return ""
        limits = charts.common_range(there)

        def panel(k: int) -> str:
            chart = made[k]
            if chart is None:
                return ""
            happened = marks.strip(self._runs[k].story, self._span, _event(k), self._told[k]) if strip else ""
            return f'{legend(chart)}<div class="wide">{drawn(chart, self._span, limits)}{happened}</div>'

        said = f'<p class="said">{escape(about)}</p>' if about else ""
        return _section(title, said + self._panels(panel))


_ABOUT_CLEARANCE = (
    "As the robot measured it and told it in its states, at the instant of their arrival. What is higher than the "
    "axis is drawn at its edge. Coloured bands: something happened, told in the row below the chart and in the table "
    "further down."
)
_ABOUT_MARGIN = (
    "What is kept beyond the limit for the sake of network and prediction. It holds as long as the error of the "
    "prediction stays below what it was a tick before."
)
_ABOUT_TIMING = (
    "When the operator's ticks began, against a period after the one before, and how long the solver took."
)


def _head(found: Figures, *, several: bool) -> str:
    lacks = "".join(f"<li>{escape(each)}</li>" for each in found.lacks)
    box = f'<div class="lacks"><b>What is missing</b><ul>{lacks}</ul></div>' if lacks else ""
    name = f'<p class="said">{escape(found.name)}</p>' if several else ""
    slow = f'<div class="lacks">{escape(found.slow)}</div>' if found.slow else ""
    return (
        f"<h1>{escape(found.scenario)}</h1>{name}<p>{words.badges(found)} {escape(words.result(found))}</p>"
        f'<p class="said">{words.what(found)}</p>{slow}{box}'
    )


def _path(found: space.Space, corners: Array, number: int) -> str:
    views = "".join(
        f"<figure><figcaption>{name}</figcaption>{space.seen(found, axes, corners, name)}</figure>"
        for name, axes in space.VIEWS
    )
    planes = space.hidden_planes(found)
    said = (
        "Blue: the tool's centre; square: where it began; green: targets; grey: obstacles where they were last; "
        "dashed: what the tool's centre must stay out of; circle: where it was nearest."
    )
    if planes:
        said += (
            f" Planes are drawn only where they are seen from the side, and not in 3-D: {', '.join(planes)}."
        )
    if found.changes:
        times = "once" if found.changes == 1 else f"{found.changes} times"
        said += f" The scene was changed {times} while it ran: obstacles are those of its end, as told below."
    data = json.dumps(space.for_turning(found, corners), separators=(",", ":")).replace("<", "\\u003c")
    return (
        f'<div class="turns" hidden><canvas class="turning" data-scene="scene{number}" tabindex="0" '
        'aria-label="path in 3-D; arrow keys turn it"></canvas>'
        '<p class="said">Drag, or arrow keys, to turn; + and − for the size.</p></div>'
        f'<div class="views">{views}</div><p class="said">{escape(said)}</p>'
        f'<script type="application/json" id="scene{number}">{data}</script>'
    )


def _versions(found: Figures) -> str:
    git = f"source {found.git}; " if found.git else ""
    named = ", ".join(f"{name} {version}" for name, version in found.versions.items())
    return (
        f'<p class="said">{escape(git)}seed {found.seed}; solver {escape(found.solver)}; {escape(named)}</p>'
    )


def _section(title: str, inner: str) -> str:
    heading = f"<h2>{escape(title)}</h2>" if title else ""
    return f"<section>{heading}{inner}</section>"


def _marks(number: int) -> str:
    return f"happened{number}"


def _event(number: int) -> str:
    return f"event{number}-"
