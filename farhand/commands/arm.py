"""`farhand arm`: arms as data: those known by name, and capsules fitted to any other."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.common.errors import InputError

arm_app = typer.Typer(
    help="Arms: which are known by name, and capsules around any other's links.", no_args_is_help=True
)


@arm_app.command("list")
def list_arms() -> None:
    """The arms that are known by name, with their joints' limits."""
    from farhand.commands.arm_tables import print_arms
    from farhand.robot_side.arm.catalogue import ARMS
    from farhand.robot_side.arm.model import model

    missing = []
    arms = []
    for name in ARMS:
        try:
            arms.append(model(name))
        except InputError as error:
            missing.append(f"{name}: {error}")
    print_arms(arms)
    for line in missing:
        typer.echo(line)


@arm_app.command()
def fit(
    model: Annotated[str, typer.Option("--model", help="An arm that is known by name, such as panda.")] = "",
    urdf: Annotated[Path | None, typer.Option("--urdf", help="The URDF of any other arm.")] = None,
    srdf: Annotated[
        Path | None, typer.Option("--srdf", help="Its SRDF: links that never collide, home, end effector.")
    ] = None,
    tool_frame: Annotated[
        str,
        typer.Option(
            "--tool-frame", help="Link that is the tool's frame (default: the SRDF's end effector)."
        ),
    ] = "",
    home: Annotated[
        str, typer.Option("--home", help="Home configuration, rad, such as 0,-0.8,0,-2.3,0,1.6,0.8.")
    ] = "",
    out: Annotated[Path | None, typer.Option("--out", help="Write the capsules to this TOML file.")] = None,
) -> None:
    """Fit capsules around an arm's links, check that every vertex lies inside, and say what they have in excess."""
    from farhand.commands.arm_tables import print_fit
    from farhand.common.process.outputs import check_writable
    from farhand.common.result_file import write_whole
    from farhand.robot_side.robots.arms import fit_files, fit_known

    if bool(model) == (urdf is not None):
        raise InputError("arm fit: give either --model or --urdf")
    if model and (srdf is not None or tool_frame or home):
        raise InputError("arm fit: --srdf, --tool-frame and --home go with --urdf; a known arm has its own")
    check_writable(out, "--out")
    if urdf is None:
        fitted, source = fit_known(model), f"--model {model}"
    else:
        fitted, source = fit_files(urdf, srdf, tool_frame, _angles(home)), f"--urdf {urdf.name}"
    print_fit(fitted)
    if out is not None:
        write_whole(out, fitted.text(source))
        typer.echo(f"capsules: {out}")


def _angles(text: str) -> tuple[float, ...] | None:
    try:
        return tuple(float(word) for word in text.split(",")) if text else None
    except ValueError:
        raise InputError(f"--home {text!r}: expected numbers with commas between them") from None
