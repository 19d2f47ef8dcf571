"""The layout in which Foxglove shows a run: the scene, what was asked and done, what happened."""

from pathlib import Path

import foxglove.layouts as fl
import msgspec

from farhand.foxglove.figures import BASE
from farhand.foxglove.view import LOG, PLAN, SCALARS, SCENE

SHIPPED = Path(__file__).with_name("layout.json")
"""The same as a file, to be imported into Foxglove."""
CAMERA = "/camera"
WIDTH = 20.0
"""s that the plots show."""
PLOTS: tuple[tuple[str, str, tuple[tuple[str, str], ...]], ...] = (
    (
        "Clearance and margin",
        "m",
        (("clearance", "#2c7fb8"), ("margin", "#d95f0e"), ("prediction_error", "#999999")),
    ),
    ("Speed", "m/s", (("speed_asked", "#d95f0e"), ("speed_done", "#2c7fb8"))),
    ("Network", "s", (("round_trip", "#756bb1"), ("age", "#d95f0e"), ("state_age", "#2c7fb8"))),
)
"""Title, unit, and labels of `/scalars` with their colours."""


def layout() -> fl.Layout:
    """What is shown where."""
    left = fl.SplitContainer(
        direction="column",
        items=[
            fl.SplitItem(proportion=3, content=_scene()),
            fl.SplitItem(
                proportion=1, content=fl.LogPanel(config=fl.LogConfig(topic_to_render=LOG), title="Reasons")
            ),
        ],
    )
    camera = fl.ImagePanel(
        config=fl.ImageConfig(image_mode=fl.ImageModeConfig(image_topic=CAMERA)), title="Camera"
    )
    right = fl.SplitContainer(
        direction="column",
        items=[
            *(fl.SplitItem(proportion=1, content=_plot(*plot)) for plot in PLOTS),
            fl.SplitItem(proportion=1, content=camera),
        ],
    )
    return fl.Layout(
        content=fl.SplitContainer(
            direction="row",
            items=[fl.SplitItem(proportion=3, content=left), fl.SplitItem(proportion=2, content=right)],
        )
    )


def layout_file() -> bytes:
    """What SHIPPED holds."""
    return msgspec.json.format(layout().to_json().encode(), indent=1) + b"\n"


def _scene() -> fl.ThreeDeePanel:
    return fl.ThreeDeePanel(
        title="Scene",
        config=fl.ThreeDeeConfig(
            fixed_frame=BASE,
            follow_tf=BASE,
            follow_mode="follow-none",
            camera_state=fl.ThreeDeeCameraState(
                distance=2.2, perspective=True, phi=62.0, theta_offset=55.0, target_offset=(0.3, 0.0, 0.25)
            ),
            scene=fl.BaseRendererSceneSettings(
                transforms=fl.BaseRendererTransforms(show_label=False, axis_size=0.05)
            ),
            topics={
                SCENE: fl.BaseRendererSceneUpdateTopicSettings(visible=True),
                PLAN: fl.BaseRendererPosesTopicSettings(visible=True, type="line", line_width=0.006),
            },
            layers={"grid": fl.BaseRendererGridLayerSettings()},
        ),
    )


def _plot(title: str, unit: str, series: tuple[tuple[str, str], ...]) -> fl.PlotPanel:
    return fl.PlotPanel(
        title=title,
        config=fl.PlotConfig(
            paths=[
                fl.PlotSeries(value=path(label), label=label, color=color, enabled=True)
                for label, color in series
            ],
            y_axis_label=unit,
            is_synced=True,
            x_axis_val="timestamp",
            time_window_mode="sliding",
            following_view_width=WIDTH,
            legend_display="floating",
        ),
    )


def path(label: str) -> str:
    """Where Foxglove finds a scalar of its label."""
    return f'{SCALARS}.scalars[:]{{label=="{label}"}}.value'
