"""The command `farhand ros2`. Heavy modules are imported only where they are used."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.commands.options import RealtimeOption, RobotOption, parse_setting


def register(app: typer.Typer) -> None:
    """Mount the command."""
    app.command()(ros2)


def ros2(
    run: Annotated[
        Path | None,
        typer.Argument(
            help="A recording, or its folder, told again with /clock (default: a running operator)."
        ),
    ] = None,
    router: Annotated[
        str, typer.Option(metavar="ENDPOINT", help="Zenoh router of the ROS 2 graph (rmw_zenohd).")
    ] = "tcp/127.0.0.1:7447",
    connect: Annotated[
        str,
        typer.Option(help="The operator's --report endpoint; with --side robot, where the robot is heard."),
    ] = "tcp/127.0.0.1:7446",
    robot: RobotOption = "ur5",
    side: Annotated[
        str,
        typer.Option(
            metavar="operator | robot", help="Beside the operator, or on the robot's side (out only)."
        ),
    ] = "operator",
    domain: Annotated[int, typer.Option(help="ROS_DOMAIN_ID, 0 to 232.")] = 0,
    namespace: Annotated[str, typer.Option(metavar="/NAME", help="Of the node.")] = "/farhand",
    distro: Annotated[
        str, typer.Option(metavar="jazzy | kilted | lyrical", help="Whose message types.")
    ] = "jazzy",
    command_type: Annotated[
        str,
        typer.Option(metavar="speed_units | unitless", help="What twists are in: m/s and rad/s, or shares."),
    ] = "speed_units",
    base_frame: Annotated[
        str, typer.Option(metavar="NAME", help="What twists call the base frame.")
    ] = "base",
    tool_frame: Annotated[
        str, typer.Option(metavar="NAME", help="What twists call the tool frame.")
    ] = "tool",
    joy_topic: Annotated[str, typer.Option(metavar="/NAME", help="Of the joystick.")] = "/joy",
    joy: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=VALUE", help="What an axis or button does, e.g. --joy deadman=button4."),
    ] = None,
    tls: Annotated[
        str,
        typer.Option(
            metavar="DIR",
            help="Certificate folder (`farhand certs`), for what of the endpoints is tls/HOST:PORT.",
        ),
    ] = "",
    speed: Annotated[float, typer.Option(min=0.1, max=100.0, help="Of a recording, times as fast.")] = 1.0,
    realtime: RealtimeOption = True,
) -> None:
    """Be a node of a ROS 2 graph over rmw_zenoh, without a ROS installation (docs/ros2.md).

    Twists and a joystick from there drive a robot whose operator runs with --steer remote; RViz shows it.
    It ends on Ctrl-C, or with the recording.
    """
    from farhand.programs.ros2 import Ros2Options, ros2_program

    options = Ros2Options(
        router=router,
        connect=connect,
        robot=robot,
        side=side,
        domain=domain,
        namespace=namespace,
        distro=distro,
        command_type=command_type,
        base_frame=base_frame,
        tool_frame=tool_frame,
        joy_topic=joy_topic,
        joy=dict(parse_setting(each, "--joy", "deadman=button4") for each in joy or []),
        tls=tls,
        run=run,
        speed=speed,
        realtime=realtime,
    )
    raise typer.Exit(ros2_program(options))
