"""Commands that are one program of a system that runs, or speak with one."""

import typer

from farhand.commands.programs.beside import console, devices, foxglove, record, steer, watch
from farhand.commands.programs.nodes import camera, operator, robot
from farhand.commands.programs.site import acknowledge, doctor, estop, handover, robots, tap


def register(app: typer.Typer) -> None:
    """Mount these commands."""
    for command in (
        operator,
        robot,
        camera,
        handover,
        estop,
        acknowledge,
        robots,
        doctor,
        watch,
        record,
        foxglove,
        console,
        steer,
        devices,
        tap,
    ):
        app.command()(command)
