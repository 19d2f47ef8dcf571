"""`farhand ur`: a real UR arm, and an emulated controller to rehearse on."""

from typing import Annotated

import typer

from farhand.common.errors import InputError

ur_app = typer.Typer(
    help="A real UR arm: check it, recover it, rehearse on an emulated one (docs/ur.md).",
    no_args_is_help=True,
)


@ur_app.command()
def emulator(
    model: Annotated[str, typer.Option("--model", help="Which arm, such as ur5.")] = "",
    scenario: Annotated[
        str, typer.Option("--scenario", help="Scenario whose arm it is, standing at its start.")
    ] = "",
    address: Annotated[
        str, typer.Option("--address", help="Of loopback, where it listens; give several emulators several.")
    ] = "127.0.0.1",
    joints: Annotated[
        str, typer.Option("--joints", help="Where the arm stands, rad, such as 0,-1.5,1.9,-1.9,-1.5,0.")
    ] = "",
    rate: Annotated[
        float | None, typer.Option("--rate", min=50, max=500, help="Cycles a second (default: the model's).")
    ] = None,
    then: Annotated[
        list[str] | None,
        typer.Option("--then", help="A fault to begin with, such as 'after 5 protective-stop'; repeatable."),
    ] = None,
    local: Annotated[bool, typer.Option("--local", help="Begin in local mode.")] = False,
    fault_port: Annotated[
        int, typer.Option("--fault-port", min=0, max=65535, help="Port that takes faults as lines, too.")
    ] = 29900,
    realtime: Annotated[
        bool, typer.Option("--realtime/--no-realtime", help="Ask for the SCHED_FIFO real-time scheduler.")
    ] = True,
) -> None:
    """An emulated UR controller on loopback: its ports, its programs, its arm in PyBullet.

    Faults are typed on its terminal, a line each: `help` says which there are.
    """
    from farhand.ur_emulator.main import EmulatorOptions, emulator_program
    from farhand.ur_emulator.models import emulated_model
    from farhand.ur_emulator.scene import start_in

    start = _angles(joints)
    if scenario:
        model, found = start_in(scenario, model)
        start = found if start is None else start
    options = EmulatorOptions(
        model=emulated_model(model or "ur5"),
        address=address,
        joints=start,
        rate_hz=rate,
        then=then or (),
        local=local,
        fault_port=fault_port,
        realtime=realtime,
    )
    raise typer.Exit(emulator_program(options))


def _angles(text: str) -> tuple[float, ...] | None:
    try:
        return tuple(float(word) for word in text.split(",")) if text else None
    except ValueError:
        raise InputError(f"--joints {text!r}: expected numbers with commas between them") from None
