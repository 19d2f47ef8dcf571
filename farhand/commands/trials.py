"""`farhand trial`: long trials that a figure in the documentation rests on."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.commands.options import JsonOption, WorkersOption
from farhand.common.errors import InputError
from farhand.common.timing.clock import local_timestamp

TrialOut = Annotated[
    Path | None, typer.Option("--out", help="Folder for the results; a trial in it goes on.")
]

trial_app = typer.Typer(help="Long trials: what the documents' figures rest on.", no_args_is_help=True)


def _listed(text: str) -> tuple[str, ...]:
    """Words with commas between them."""
    return tuple(word.strip() for word in text.split(",") if word.strip())


def _folder(out: Path | None, kind: str) -> Path:
    return out if out is not None else Path("runs") / f"{local_timestamp()}-{kind}"


@trial_app.callback()
def trial() -> None:
    """Long trials: what the documents' figures rest on."""


@trial_app.command()
def ur(
    address: Annotated[
        str, typer.Option("--address", help="Of loopback, where the emulator listens.")
    ] = "127.0.0.9",
    rate: Annotated[
        float, typer.Option("--rate", min=50, max=500, help="Of the emulated controller, Hz.")
    ] = 500.0,
    faults: Annotated[
        str,
        typer.Option(
            "--faults", help="Only those with one of these words in their names, such as kill,cable."
        ),
    ] = "",
    drive: Annotated[
        bool, typer.Option("--drive", help="No faults: the demo's task, beside the simulated arm.")
    ] = False,
    networks: Annotated[
        str, typer.Option("--networks", help="With --drive: these, with blanks between them.")
    ] = "",
    as_json: JsonOption = False,
) -> None:
    """Everything that breaks around a UR arm, in the emulator: how long does it move on, and does it wait?

    Exit code 0: the arm stood within 0.2 s each time, and moved again only after an acknowledgement. 1: it did not.
    """
    from farhand.trials.ur.faults import run_ur_trial
    from farhand.ur_emulator.main import check_loopback

    check_loopback(address)
    if drive:
        from farhand.trials.ur.drives import run_drives

        raise typer.Exit(run_drives(address, rate, tuple(networks.split()), as_json))
    words = _listed(faults)
    raise typer.Exit(run_ur_trial(address, rate, words, as_json))


@trial_app.command()
def guard(
    robots: Annotated[str, typer.Option(help="Some of ur5,panda,point,box.")] = "ur5,panda,point,box",
    share: Annotated[
        float,
        typer.Option(min=0.0001, max=100.0, help="Of the runs: 1000 UR5, 300 Panda, 2000 point, 2000 box."),
    ] = 1.0,
    speeds: Annotated[str, typer.Option(help="Of movers, m/s; 0: all stand.")] = "0,0.1,0.3,0.5",
    seed: Annotated[int, typer.Option(min=0, help="Seed of scenes, commands and errors.")] = 1,
    on: Annotated[bool, typer.Option("--guard/--no-guard", help="Whether there is a guard.")] = True,
    workers: WorkersOption = 0,
    out: TrialOut = None,
) -> None:
    """Commands that are chosen to collide, among random shapes: does the guard keep its distance?

    Exit code 0: it does, movers of up to 0.3 m/s included. 1: it does not. 2: bad input.
    """
    from farhand.trials.safety.guard import RUNS, Trial, run_trial

    named = _listed(robots)
    for name in named:
        if name not in RUNS:
            raise InputError(f"--robots {name!r}: must be some of {','.join(RUNS)}")
    try:
        fast = tuple(float(word) for word in speeds.split(","))
    except ValueError:
        raise InputError(f"--speeds {speeds!r}: must be numbers with commas between them, m/s") from None
    if not named or not all(0.0 <= speed <= 5.0 for speed in fast):
        raise InputError(
            f"--speeds {speeds!r}: must lie within 0 and 5 m/s" if named else "--robots: none named"
        )
    trial = Trial(robots=named, share=share, speeds=fast, seed=seed, guarded=on)
    raise typer.Exit(run_trial(trial, _folder(out, "guard"), workers))


@trial_app.command()
def fuzz(
    targets: Annotated[str, typer.Option(help="Some, with commas between them; empty: all.")] = "",
    share: Annotated[
        float, typer.Option(min=0.0001, max=1000.0, help="Of the inputs: 1 is 12.5 million in all.")
    ] = 1.0,
    workers: Annotated[int, typer.Option(min=1, max=64, help="Targets at the same time.")] = 1,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for corpus and findings; a campaign in it goes on.")
    ] = None,
) -> None:
    """Coverage-guided fuzzing of every place where bytes come in, by atheris, at the lowest priority.

    Exit code 0: no input broke a promise. 1: one did; it is kept. 2: bad input.
    """
    from farhand.trials.fuzz.campaign import Campaign, run_campaign
    from farhand.trials.fuzz.registry import NAMES, check_name

    named = _listed(targets) or NAMES
    for name in named:
        check_name(name)
    raise typer.Exit(run_campaign(Campaign(named, share, _folder(out, "fuzz")), workers))


@trial_app.command()
def errors(
    names: Annotated[
        str, typer.Option("--errors", help="Some ids of the table, with commas between them; empty: all.")
    ] = "",
    runs: Annotated[int, typer.Option(min=1, max=100_000, help="Of each.")] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Of networks, instants and the hostile client.")] = 1,
    workers: WorkersOption = 0,
    out: TrialOut = None,
) -> None:
    """The eight communication errors of IEC 61784-3, by the network and by a hostile client, in virtual time.

    Exit code 0: nothing moved that no fresh command of the lawful operator explains, and nothing came too near to an
    obstacle where a guard is on. 1: something did, or a run crashed. 2: bad input. Rows marked †, in which a lawful
    session is forged in all its fields, are excepted from the first.
    """
    from farhand.laboratory.campaigns.pools import LocalPool
    from farhand.trials.errors.errors import ERRORS
    from farhand.trials.errors.run_errors import run_errors

    named = _listed(names) or tuple(ERRORS)
    raise typer.Exit(run_errors(named, runs, seed, LocalPool(workers), _folder(out, "errors")))
