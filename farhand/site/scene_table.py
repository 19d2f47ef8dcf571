"""The obstacles of a scene as a table, or as JSON that has them as a scenario's file does."""

import json

import msgspec
from rich.table import Table

from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.process.console import page, whole


def print_scene(scene: Scene, *, as_json: bool) -> None:
    """Print what is around a robot."""
    if as_json:
        obstacles = msgspec.to_builtins(scene.obstacles)
        print(json.dumps({"robot": scene.source, "revision": scene.changes, "obstacles": obstacles}))
        return
    table = Table(title_justify="left")
    for column in ("obstacle", "shape", "at (m)", "motion"):
        table.add_column(column, overflow="fold")
    for each in scene.obstacles:
        table.add_row(each.id, _shape(each), _place(each.position), _motion(each))
    console = page()
    console.print(whole(table, console) if scene.obstacles else f"{scene.source}: no obstacle")
    print(f"{scene.source}: scene revision {scene.changes}, {len(scene.obstacles)} obstacles")


def _shape(obstacle: Obstacle) -> str:
    said = msgspec.to_builtins(obstacle.shape)
    kind = said.pop("kind")
    corners = said.pop("vertices", None)
    if corners is not None:
        return f"{kind} of {len(corners)} corners"
    return " ".join([kind, *(f"{key} {_value(value)}" for key, value in said.items())])


def _value(value: object) -> str:
    if isinstance(value, list | tuple):
        return " ".join(f"{v:g}" for v in value)
    return f"{value:g}" if isinstance(value, float | int) else str(value)


def _place(position: tuple[float, float, float]) -> str:
    return " ".join(f"{x:.3f}" for x in position)


def _motion(obstacle: Obstacle) -> str:
    if obstacle.path:
        return f"shuttles at {obstacle.speed:g} m/s"
    return f"{_value(obstacle.velocity)} m/s" if obstacle.moves else "stands"
