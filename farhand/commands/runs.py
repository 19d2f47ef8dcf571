"""Commands that run a task, and lists of what is built in. Heavy modules are imported only where they are used."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.commands.options import (
    STEERS,
    DownlinkOption,
    GuardOption,
    JsonOption,
    MarginOption,
    NetworkOption,
    PredictorOption,
    RateOption,
    ScenarioOption,
    SeedOption,
    SetOption,
    SimulatedSteerOption,
    SolverOption,
    TimeLimitOption,
    TimelineOption,
    UplinkOption,
    chosen_network,
    chosen_scenario,
)
from farhand.common.errors import InputError
from farhand.operator_side.steering.registry import DEVICES

OutOption = Annotated[
    Path | None, typer.Option("--out", help="Folder for the results (default: runs/<time>-<scenario>).")
]
ForceOption = Annotated[bool, typer.Option("--force", help="Replace the run that is in --out already.")]
DemoSteerOption = Annotated[
    str | None,
    typer.Option(
        metavar=f"{STEERS} | browser",
        help="What steers (default: scenario's); browser: you, in a browser; gamepad, spacemouse: you, at that.",
    ),
]

DemoCameraOption = Annotated[
    str | None,
    typer.Option(
        metavar="off | pybullet | device:PATH",
        help="With --steer browser: what the camera shows (default: pybullet for an arm, else off).",
    ),
]


def demo(
    scenario: ScenarioOption = "ur5-obstacle",
    network: NetworkOption = None,
    uplink: UplinkOption = None,
    downlink: DownlinkOption = None,
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    steer: DemoSteerOption = None,
    camera: DemoCameraOption = None,
    rate: RateOption = None,
    guard: GuardOption = None,
    settings: SetOption = None,
    seed: SeedOption = 0,
    time_limit: TimeLimitOption = 90.0,
    timeline: TimelineOption = None,
    out: OutOption = None,
    force: ForceOption = False,
    as_json: JsonOption = False,
) -> None:
    """Drive a robot past an obstacle over an emulated network: three programs, one live status, one summary.

    With --steer browser, gamepad or spacemouse you drive it, without a time limit, until Ctrl-C.

    Exit code 0: safe and finished. 1: not safe, or not finished. 2: bad input.
    """
    from farhand.demo.cast import Hands
    from farhand.demo.demo import has_desktop, run_demo
    from farhand.robot_side.camera.settings import OFF, VIEW, check_camera
    from farhand.runs.run import Run

    browser = steer == "browser"
    steer = "remote" if browser else steer
    if steer is not None and steer.partition(":")[0] not in DEVICES:
        DEVICES.get(steer, "--steer", beside=("browser",))
    if camera is not None and check_camera(camera, may_be_off=True) != OFF and not browser:
        raise InputError("--camera: is for who drives in a browser; it goes with --steer browser")
    chosen = chosen_scenario(
        scenario,
        settings,
        guard=guard,
        rate=rate,
        margin=margin,
        predictor=predictor,
        solver=solver,
        steer=steer,
    )
    if camera is None:
        camera = VIEW if browser and chosen.robot.kind in ("arm", "ur5") else OFF
    run = Run(
        scenario=chosen,
        network=chosen_network(chosen, scenario, network, uplink, downlink),
        seed=seed,
        time_limit=time_limit,
        timeline=timeline,
    )
    hands = Hands(browser=browser, opens=browser and has_desktop(), camera=camera)
    raise typer.Exit(run_demo(run, out=out, force=force, as_json=as_json, hands=hands))


def simulate(
    scenario: ScenarioOption = "ur5-obstacle",
    network: NetworkOption = None,
    uplink: UplinkOption = None,
    downlink: DownlinkOption = None,
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    steer: SimulatedSteerOption = None,
    rate: RateOption = None,
    guard: GuardOption = None,
    settings: SetOption = None,
    seed: SeedOption = 0,
    time_limit: TimeLimitOption = 90.0,
    computing_time: Annotated[
        float, typer.Option(min=0.0, max=1000.0, help="Modelled computing time of a control tick, ms.")
    ] = 20.0,
    timeline: TimelineOption = None,
    out: OutOption = None,
    force: ForceOption = False,
    as_json: JsonOption = False,
) -> None:
    """Run one task in virtual time: the same nodes, summary and figure as the demo, in a fraction of the time.

    Exit code 0: safe and finished. 1: not safe, or not finished. 2: bad input.
    """
    from farhand.laboratory.simulate_run import run_simulation
    from farhand.runs.run import Run

    chosen = chosen_scenario(
        scenario,
        settings,
        guard=guard,
        rate=rate,
        margin=margin,
        predictor=predictor,
        solver=solver,
        steer=steer,
    )
    run = Run(
        scenario=chosen,
        network=chosen_network(chosen, scenario, network, uplink, downlink),
        seed=seed,
        time_limit=time_limit,
        computing_time=(computing_time / 1000.0,),
        timeline=timeline,
    )
    raise typer.Exit(run_simulation(run, out=out, force=force, as_json=as_json))


def summarise(
    folder: Annotated[Path, typer.Argument(help="Folder with operator.json, netem.json, robot.json.")],
    scenario: Annotated[
        str | None, typer.Option(help="Built-in scenario or TOML file, where the folder holds none.")
    ] = None,
    network: NetworkOption = None,
    uplink: UplinkOption = None,
    downlink: DownlinkOption = None,
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    settings: SetOption = None,
    seed: SeedOption = 0,
    why: Annotated[str, typer.Option(help="What went wrong, where the files cannot say it.")] = "",
    as_json: JsonOption = False,
) -> None:
    """Summary and figure of a run whose programs ran on hosts of their own; options as in that run.

    The scenario is the folder's own scenario.toml where there is one, else ur5-obstacle or what --scenario says.

    Exit code 0: safe and finished. 1: not safe, or not finished. 2: bad input.
    """
    from farhand.common.process.console import page
    from farhand.report.write import conclude_report
    from farhand.runs.conclude import run_summarise, scenario_of_folder
    from farhand.runs.files import RECORDING
    from farhand.runs.run import Run

    where = scenario_of_folder(folder, scenario)
    chosen = chosen_scenario(where, settings, margin=margin, predictor=predictor, solver=solver)
    run = Run(
        scenario=chosen,
        network=chosen_network(chosen, where, network, uplink, downlink),
        seed=seed,
    )
    code = run_summarise(run, folder, why=why, as_json=as_json)
    if (folder / RECORDING).is_file():
        conclude_report(folder, page(stderr=as_json))
    raise typer.Exit(code)


def export(
    runs: Annotated[list[Path], typer.Argument(help="Folders of runs, or their recordings.")],
    to: Annotated[
        str, typer.Option("--to", metavar="lerobot | rosbag2 | csv | parquet", help="In which form.")
    ],
    out: Annotated[Path, typer.Option("--out", help="Folder to make.")],
    actions: Annotated[
        str | None,
        typer.Option(
            "--actions",
            metavar="velocity | position",
            help="With --to lerobot: what `action` is: the velocity asked for (default), or the place it leads to.",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the export that is in --out already.")
    ] = False,
) -> None:
    """Write recordings as a LeRobot dataset, a ROS 2 bag, or tables.

    Exit code 0: all is there. 1: something is missing in a recording, and is said. 2: bad input.
    """
    from farhand.exports.export import run_export

    raise typer.Exit(run_export(runs, to, out, force=force, actions=actions))


def scenarios() -> None:
    """What scenarios are built in."""
    from farhand.commands.options import print_rows
    from farhand.runs.scenario import built_in_names, load_scenario

    print_rows([(name, load_scenario(name).description) for name in built_in_names()])


def networks() -> None:
    """What networks are built in, and how to write one."""
    from farhand.commands.options import print_rows
    from farhand.netem.impairments.registry import described

    print_rows([("none", "nothing is delayed"), *described()])


def register(app: typer.Typer) -> None:
    """Mount these commands."""
    for command in (demo, simulate, summarise, export, scenarios, networks):
        app.command()(command)
