"""Draws docs/figures/foxglove-topics.png: what the topics of a recording say, as Foxglove is told it.

`python docs/figures/foxglove_topics.py RUN.mcap`. No picture of Foxglove: the same messages, by matplotlib.
"""

import json
import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

OUT = Path(__file__).with_name("foxglove-topics.png")
SHOWN = {
    "clearance": "clearance (m)",
    "margin": "margin (m)",
    "speed_asked": "asked (m/s)",
    "speed_done": "done (m/s)",
}


def read(path: Path) -> tuple[list[Any], dict[str, list[tuple[float, float]]], list[Any], dict[str, Any]]:
    """Tool positions, scalars by label, events, and the newest entity of each name."""
    tool, scalars, events, entities = [], {label: [] for label in SHOWN}, [], {}
    first = None
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, _, message in reader.iter_messages(topics=["/scalars"]):
            first = first or message.log_time
            for each in json.loads(message.data)["scalars"]:
                if each["label"] in scalars:
                    scalars[each["label"]].append(((message.log_time - first) * 1e-9, each["value"]))
        for _, channel, _, said in reader.iter_decoded_messages(topics=["/tf", "/scene", "/events"]):
            if channel.topic == "/tf":
                tool += [
                    (t.translation.x, t.translation.y, t.translation.z)
                    for t in said.transforms
                    if t.child_frame_id == "tool"
                ]
            elif channel.topic == "/scene":
                entities |= {each.id: each for each in said.entities}
            else:
                begin, end = (
                    at.seconds + at.nanos * 1e-9 - first * 1e-9 for at in (said.start_time, said.end_time)
                )
                events.append((begin, end, {each.key: each.value for each in said.metadata}["kind"]))
    return tool, scalars, events, entities


def draw(path: Path) -> None:
    """Read a recording and draw it."""
    tool, scalars, events, entities = read(path)
    figure = plt.figure(figsize=(11, 4.6), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.3))
    scene = figure.add_subplot(grid[:, 0], projection="3d")
    u, v = np.mgrid[0 : 2 * np.pi : 24j, 0 : np.pi : 13j]
    for name, entity in entities.items():
        if name.startswith(("obstacle/", "margin/", "target/")):
            for ball in entity.spheres:
                p, r = ball.pose.position, ball.size.x / 2
                x, y, z = (
                    p.x + r * np.cos(u) * np.sin(v),
                    p.y + r * np.sin(u) * np.sin(v),
                    p.z + r * np.cos(v),
                )
                c = ball.color
                scene.plot_surface(x, y, z, color=(c.r, c.g, c.b), alpha=max(c.a * 0.8, 0.15), linewidth=0)
    scene.plot(*np.array(tool).T, color="#2c7fb8")
    scene.set(title="/scene and the tool of /tf", xlabel="x (m)", ylabel="y (m)", zlabel="z (m)")
    scene.set_aspect("equal")
    scene.locator_params(nbins=3)
    for row, labels in enumerate((("clearance", "margin"), ("speed_asked", "speed_done"))):
        plot = figure.add_subplot(grid[row, 1])
        for label in labels:
            plot.plot(*np.array(scalars[label]).T, label=SHOWN[label])
        for begin, end, kind in events:
            if kind in ("filter", "stop", "guard"):
                plot.axvspan(
                    begin,
                    max(end, begin + 0.05),
                    alpha=0.15,
                    color="#d95f0e" if kind == "filter" else "#444444",
                )
        plot.legend(loc="upper right", fontsize=8)
        plot.set(xlabel="s" if row else "", title="/scalars, with the spans of /events" if not row else "")
    figure.savefig(OUT, dpi=110)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
