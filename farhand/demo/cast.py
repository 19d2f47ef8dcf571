"""The programs of a demo: who takes part, how each is called, and where they meet."""

from dataclasses import dataclass
from pathlib import Path

from farhand.common.link.ports import free_ports
from farhand.operator_side.devices.sources import SOURCES
from farhand.operator_side.steering.registry import DEVICES
from farhand.programs.command_line import (
    CameraWords,
    ConsoleWords,
    NetemWords,
    OperatorWords,
    RecordWords,
    RobotWords,
    SteerWords,
    Words,
)
from farhand.programs.wiring import OPERATOR_NAME
from farhand.robot_side.camera.settings import OFF
from farhand.runs.files import NETEM, OPERATOR, RECORDING, ROBOT
from farhand.runs.run import Run
from farhand.runs.run_folder import write_scenario

RECORD, CAMERA, STEER = RecordWords.COMMAND, CameraWords.COMMAND, SteerWords.COMMAND
BESIDE = (RECORD, CAMERA)
"""Without these a demo goes on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hands:
    """How a person takes part.

    Attributes:
        browser: a person drives in one.
        opens: whether it is opened here.
        camera: what shows the robot to the browser, as `farhand camera --camera` has it.
    """

    browser: bool = False
    opens: bool = False
    camera: str = OFF


@dataclass(frozen=True, slots=True)
class Cast:
    """Attributes:
    programs: in the order of their start.
    report: the operator's endpoint for those who watch.
    page: address of the console; empty: there is none.
    """

    programs: tuple[Words, ...]
    report: str
    page: str


def cast_of(run: Run, folder: Path, left: Path, hands: Hands) -> Cast:
    """The programs of a run, on ports of this host that are free now.

    Args:
        run: what to do.
        folder: of the run; the scenario is written there.
        left: where the programs leave their results.
        hands: see there.
    """
    *ports, page = free_ports(6)
    operator_side, robot_side, report, control, beside_robot = (f"tcp/127.0.0.1:{port}" for port in ports)
    scenario, robot = str(write_scenario(run, folder)), run.scenario.robot.kind
    filmed = hands.camera != OFF
    programs: list[Words] = [
        NetemWords(
            listen_operator=operator_side,
            listen_robot=robot_side,
            uplink=run.network.uplink.text,
            downlink=run.network.downlink.text,
            seed=run.seed,
            timeline=run.timeline,
            control=control,
            stats=str(left / NETEM),
        ),
        RobotWords(
            scenario=scenario,
            robot=robot,
            connect=(robot_side,),
            listen=(beside_robot,) if filmed else (),
            result=str(left / ROBOT),
        ),
        OperatorWords(
            name=OPERATOR_NAME,
            scenario=scenario,
            robot=robot,
            connect=(operator_side,),
            report=report,
            seed=run.seed,
            time_limit=run.time_limit if DEVICES.get(run.scenario.steering.kind).ends_with_targets else None,
            result=str(left / OPERATOR),
        ),
        RecordWords(out=str(folder / RECORDING), connect=report, netem=control, robot=robot),
    ]
    if hands.browser:
        programs.append(
            ConsoleWords(
                connect=report,
                listen=f"127.0.0.1:{page}",
                robot=robot,
                netem=control,
                opens=hands.opens,
            )
        )
    if run.scenario.steering.kind in SOURCES:
        device = run.scenario.steering.kind
        programs.append(SteerWords(device=device, connect=report, robot=robot, scenario=scenario))
    if filmed:  # it hears the robot on an endpoint of its own, as no network lies between
        connect = (beside_robot, robot_side)
        programs.append(CameraWords(camera=hands.camera, scenario=scenario, robot=robot, connect=connect))
    return Cast(tuple(programs), report, f"http://127.0.0.1:{page}/" if hands.browser else "")
