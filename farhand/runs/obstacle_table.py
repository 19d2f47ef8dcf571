"""What people may write of obstacles and the wire does not know: mesh files, and a plane by its normal."""

import math
from pathlib import Path
from typing import Annotated, Any

import msgspec

from farhand.common.errors import InputError, ScenarioError
from farhand.common.messages.scene import MAX_OBSTACLES, Obstacle
from farhand.common.scenario.known_keys import explained
from farhand.common.scenario.reader import non_finite_key
from farhand.common.shapes.cover import EXCESS, MAX_SPHERES, MOST_SPHERES, closely_covered
from farhand.common.shapes.mesh_file import read_mesh
from farhand.common.shapes.plane import Plane
from farhand.common.toml import read_toml

MOST_BYTES = 900_000
"""Of all obstacles on the wire, of which a message holds 1 MiB."""


def read_obstacles(name_or_path: str) -> tuple[Obstacle, ...]:
    """The obstacles of a scenario's file, or of one that holds nothing else; raises ScenarioError.

    A file that says nothing of obstacles is refused: it would take all of them away.
    """
    table = read_toml(name_or_path, "scenario", ScenarioError)
    if "obstacles" not in table:
        raise ScenarioError(
            f"scenario {name_or_path}: has no [[obstacles]]; to have none at all: obstacles = []"
        )
    return obstacles_from(table["obstacles"], f"scenario {name_or_path}", Path(name_or_path).parent)


def obstacles_from(tables: object, where: str, folder: Path) -> tuple[Obstacle, ...]:
    """Obstacles as a scenario writes them.

    Args:
        tables: a list of nested dictionaries, as TOML gives it.
        where: names the source in errors.
        folder: what the names of mesh files are relative to.

    Raises ScenarioError with one clear line.
    """
    bad = non_finite_key({"obstacles": tables})
    if bad:
        raise ScenarioError(f"{where}: {bad}: must be a finite number")
    try:
        found = msgspec.convert(settled({"obstacles": tables}, folder), _Obstacles).obstacles
        check_shapes(found)
    except msgspec.ValidationError as error:
        raise ScenarioError(f"{where}: {explained(str(error), _Obstacles)}") from None
    except InputError as error:
        raise ScenarioError(f"{where}: {error}") from None
    return found


class _Obstacles(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    obstacles: Annotated[tuple[Obstacle, ...], msgspec.Meta(max_length=MAX_OBSTACLES)]


def settled(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The scenario's table with vertices for files and orientations for normals; what is no obstacle stays.

    Args:
        table: as TOML gives it.
        folder: what the files' names are relative to.

    Raises:
        ScenarioError: a file or a normal will not do; names the key.
    """
    obstacles = table.get("obstacles")
    if not isinstance(obstacles, list) or len(obstacles) > MAX_OBSTACLES:
        return table
    found = [
        _settled(o, f"obstacles[{k}]", folder) if isinstance(o, dict) else o for k, o in enumerate(obstacles)
    ]
    return table | {"obstacles": found}


def _settled(obstacle: dict[str, Any], key: str, folder: Path) -> dict[str, Any]:
    shape = obstacle.get("shape")
    if not isinstance(shape, dict):
        return obstacle
    if shape.get("kind") == "mesh" and "file" in shape:
        obstacle = obstacle | {"shape": _from_file(shape, f"{key}.shape", folder)}
    if shape.get("kind") == "plane" and "normal" in obstacle:
        rest = {name: value for name, value in obstacle.items() if name != "normal"}
        if "orientation" in rest:
            raise ScenarioError(f"{key}.normal: there is an orientation already; one of both is enough")
        obstacle = rest | {"orientation": _facing(obstacle["normal"], f"{key}.normal")}
    return obstacle


def _from_file(shape: dict[str, Any], key: str, folder: Path) -> dict[str, Any]:
    file, scale = shape["file"], shape.get("scale", 1.0)
    unknown = sorted(set(shape) - {"kind", "file", "scale"})
    if unknown:
        raise ScenarioError(f"{key}: a mesh from a file has no key `{unknown[0]}`; it has file and scale")
    if not isinstance(file, str):
        raise ScenarioError(f"{key}.file: expected the name of an STL or OBJ file")
    if isinstance(scale, bool) or not isinstance(scale, int | float) or not 0.0 < scale <= 1e3:
        raise ScenarioError(f"{key}.scale: expected a number above 0, at most 1000")
    try:
        return {"kind": "mesh", "vertices": read_mesh(folder / file, float(scale))}
    except InputError as error:
        raise ScenarioError(f"{key}.file: {file} {error}") from None


def _facing(normal: Any, key: str) -> list[float]:
    """The quaternion (w, x, y, z) that turns the z axis into the direction of `normal`."""
    numbers = isinstance(normal, list | tuple) and len(normal) == 3
    if not numbers or not all(isinstance(n, int | float) and not isinstance(n, bool) for n in normal):
        raise ScenarioError(f"{key}: expected three numbers, the direction to the free side")
    if not 1e-9 <= max(map(abs, normal)) <= 1e9:
        raise ScenarioError(f"{key}: has no direction")
    length = math.hypot(*normal)
    x, y, z = (n / length for n in normal)
    if z < -1.0 + 1e-12:
        return [0.0, 1.0, 0.0, 0.0]
    # Half way between the axis and the normal: w = cos(angle / 2), (x, y) = sin(angle / 2) times the axis.
    w = math.sqrt(0.5 * (1.0 + z))
    return [w, -y / (2.0 * w), x / (2.0 * w), 0.0]


def check_shapes(obstacles: tuple[Obstacle, ...]) -> None:
    """Raise ScenarioError where the controller could not see the shapes as spheres, or the wire not carry them."""
    try:
        size = len(msgspec.msgpack.encode(obstacles))
    except UnicodeEncodeError:
        raise ScenarioError(
            "obstacles: an id holds bytes that are no text; expected 1 to 64 characters"
        ) from None
    if size > MOST_BYTES:
        raise ScenarioError(
            f"obstacles: take {size} bytes on the wire, at most {MOST_BYTES} are possible; leave out vertices of meshes"
        )
    total = 0
    for index, obstacle in enumerate(obstacles):
        if isinstance(obstacle.shape, Plane):
            continue
        found = closely_covered(obstacle.shape)
        if found is None:
            raise ScenarioError(
                f"obstacles[{index}].shape: takes more than {MAX_SPHERES} spheres to cover it to "
                f"{EXCESS * 1e3:g} mm, as the controller sees it; make what is so large of planes"
            )
        total += len(found[1])
        if total > MOST_SPHERES:
            raise ScenarioError(
                f"obstacles: all shapes together take more than {MOST_SPHERES} spheres to cover them to "
                f"{EXCESS * 1e3:g} mm, as the controller sees them; make what is large of planes"
            )
