"""`farhand scene`: obstacles of a robot that runs. Heavy modules are imported only where they are used."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.commands.options import RobotOption, RouterOption, TlsOption

scene_app = typer.Typer(help="Look at, and change, what is around a robot that runs.", no_args_is_help=True)

ConnectOption = Annotated[
    list[str] | None,
    typer.Option(
        help="Endpoint of the robot, the emulator, or an operator's --report (default: all of this host)."
    ),
]


@scene_app.command("set")
def set_scene(
    file: Annotated[str, typer.Argument(metavar="FILE", help="TOML with [[obstacles]], such as a scenario.")],
    robot: RobotOption = "ur5",
    connect: ConnectOption = None,
    tls: TlsOption = "",
    router: RouterOption = False,
) -> None:
    """Replace all obstacles by those of a file; what moves begins anew.

    Exit code 0: the robot has them. 1: it refused, or was not heard, and why is said. 2: bad input.
    """
    from farhand.runs.obstacle_table import read_obstacles
    from farhand.site.scene import change_scene
    from farhand.site.scene_asking import Change

    change = Change("set", read_obstacles(file))
    raise typer.Exit(change_scene(robot, connect or [], tls, router, change))


@scene_app.command("add")
def add(
    file: Annotated[
        str,
        typer.Argument(metavar="[FILE]", help="TOML with [[obstacles]] that come; or one by the options."),
    ] = "",
    name: Annotated[str, typer.Option("--id", help="Name of the obstacle.")] = "",
    shape: Annotated[
        str, typer.Option(metavar="sphere | capsule | box | plane | mesh:FILE", help="What it is.")
    ] = "sphere",
    at: Annotated[str, typer.Option(metavar="X,Y,Z", help="Where it is, in the robot's base frame, m.")] = "",
    size: Annotated[
        str,
        typer.Option(
            help="Sphere: radius. Capsule: radius,half_length. Box: its three half_extents. Mesh: scale. In m."
        ),
    ] = "",
    orientation: Annotated[str, typer.Option(metavar="W,X,Y,Z", help="Unit quaternion of its frame.")] = "",
    normal: Annotated[str, typer.Option(metavar="X,Y,Z", help="Of a plane, to its free side.")] = "",
    velocity: Annotated[str, typer.Option(metavar="X,Y,Z", help="Of one that goes straight on, m/s.")] = "",
    robot: RobotOption = "ur5",
    connect: ConnectOption = None,
    tls: TlsOption = "",
    router: RouterOption = False,
) -> None:
    """Bring obstacles to those that are there.

    Exit code 0: the robot has them. 1: it refused, or was not heard, and why is said. 2: bad input.
    """
    from farhand.common.errors import InputError
    from farhand.runs.obstacle_table import obstacles_from, read_obstacles
    from farhand.site.obstacle_words import obstacle_table
    from farhand.site.scene import change_scene
    from farhand.site.scene_asking import Change

    by_options = any((name, at, size, orientation, normal, velocity))
    if by_options == bool(file):
        raise InputError("scene add: give a FILE, or one obstacle by --id, --shape, --at and --size")
    if file:
        obstacles = read_obstacles(file)
    else:
        table = obstacle_table(
            name, shape, at, size, orientation=orientation, normal=normal, velocity=velocity
        )
        obstacles = obstacles_from([table], "scene add", Path())
    raise typer.Exit(change_scene(robot, connect or [], tls, router, Change("add", obstacles)))


@scene_app.command("remove")
def remove(
    names: Annotated[list[str], typer.Argument(metavar="ID...", help="Names of the obstacles that go.")],
    robot: RobotOption = "ur5",
    connect: ConnectOption = None,
    tls: TlsOption = "",
    router: RouterOption = False,
) -> None:
    """Take obstacles away: all of those that are named, or none.

    Exit code 0: they are gone. 1: the robot refused, or was not heard, and why is said. 2: bad input.
    """
    from farhand.site.scene import change_scene
    from farhand.site.scene_asking import Change

    raise typer.Exit(change_scene(robot, connect or [], tls, router, Change("remove", gone=tuple(names))))


@scene_app.command("list")
def list_scene(
    robot: RobotOption = "ur5",
    connect: ConnectOption = None,
    tls: TlsOption = "",
    router: RouterOption = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
) -> None:
    """Show the obstacles as the robot announces them now.

    Exit code 0: they are shown. 1: the robot was not heard. 2: bad input.
    """
    from farhand.site.scene import hear_scene
    from farhand.site.scene_table import print_scene

    scene = hear_scene(robot, connect or [], tls, router)
    if scene is None:
        raise typer.Exit(1)
    print_scene(scene, as_json=as_json)
