"""`farhand ur`: a real UR arm, and an emulated controller to rehearse on."""

from typing import Annotated

import typer

from farhand.commands.options import JsonOption, SetOption, chosen_scenario, on_a_real_arm, settings_at
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
    found = start_in(scenario, model) if scenario else None
    options = EmulatorOptions(
        model=emulated_model(model or "ur5") if found is None else found.model,
        arm=None if found is None else found.arm,
        address=address,
        joints=found.joints if found is not None and start is None else start,
        rate_hz=rate,
        then=then or (),
        local=local,
        fault_port=fault_port,
        realtime=realtime,
    )
    raise typer.Exit(emulator_program(options))


HostOption = Annotated[str, typer.Option("--host", help="Address of the arm's controller.")]


@ur_app.command()
def check(
    host: HostOption,
    scenario: Annotated[
        str,
        typer.Option("--scenario", help="Scenario that shall be run: its model, payload, tool, deadline."),
    ] = "",
    model: Annotated[str, typer.Option("--model", help="Which arm it shall be, such as ur5.")] = "",
    settings: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Look whether a UR arm can be driven from here, and say what to do about what is in the way. Moves nothing.

    Exit code 0: nothing is in the way. 1: something is. 2: bad input.
    """
    from farhand.common.scenario.section import checked_settings
    from farhand.robot_side.robots.arms import chosen_arm
    from farhand.robot_side.robots.ur_arm import UrRobot
    from farhand.robot_side.ur.settings import UrSettings
    from farhand.runs.scenario import load_scenario
    from farhand.site.ur.check import run_check

    host = _address(host)
    if not scenario and not model:
        if settings:
            raise InputError("--set: goes with --scenario")
        lag = load_scenario("ur5-obstacle").robot.lag
        raise typer.Exit(run_check(host, None, UrSettings(), lag, as_json))
    if scenario and model:
        raise InputError("ur check: give either --scenario or --model; a scenario has a model")
    chosen = chosen_scenario(scenario or "ur5-obstacle", settings_at(host, settings))
    chosen = on_a_real_arm(chosen, host, model)
    own: UrSettings = checked_settings(chosen.robot.own.get("ur", {}), UrRobot, "robot.ur")
    raise typer.Exit(run_check(host, chosen_arm(chosen.robot), own, chosen.robot.lag, as_json))


@ur_app.command()
def recover(
    host: HostOption,
    patience: Annotated[
        float,
        typer.Option("--patience", min=1, max=86_400, help="How long to wait for somebody at the arm, s."),
    ] = 300.0,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask: somebody has looked at the arm.")] = False,
) -> None:
    """Walk through what clears a stopped arm: unlock it, power it on, end its paused program. Moves nothing.

    It asks before it unlocks a stop or powers on. Exit code 0: it can be driven again, after an operator's
    acknowledgement. 1: it cannot. 2: bad input.
    """
    from farhand.site.ur.recover import run_recover

    host = _address(host)
    raise typer.Exit(run_recover(host, patience, lambda: yes or _confirmed()))


def _address(host: str) -> str:
    from farhand.robot_side.ur.settings import address_of

    settings_at(host, None)
    return address_of(host)


def _confirmed() -> bool:
    """Whether a person says yes; without a person it is no."""
    try:
        return typer.confirm("go on?", default=False, err=True)
    except typer.Abort:
        return False


def _angles(text: str) -> tuple[float, ...] | None:
    try:
        return tuple(float(word) for word in text.split(",")) if text else None
    except ValueError:
        raise InputError(f"--joints {text!r}: expected numbers with commas between them") from None
