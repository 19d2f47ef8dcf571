"""Move a robot that is far away, over a network that delays, jitters and loses messages, without it hitting anything.

The public names; each is imported only when it is used. docs/extend.md says what one does with them.
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from farhand.common.errors import FarhandError as FarhandError
    from farhand.common.errors import InputError as InputError
    from farhand.common.errors import ScenarioError as ScenarioError
    from farhand.common.geometry import Twist as Twist
    from farhand.common.link.link import Packet as Packet
    from farhand.common.messages.base import Vector3 as Vector3
    from farhand.common.messages.command import VelocityCommand as VelocityCommand
    from farhand.common.messages.report import ControlReport as ControlReport
    from farhand.common.messages.scene import Obstacle as Obstacle
    from farhand.common.messages.scene import Scene as Scene
    from farhand.common.messages.state import RobotState as RobotState
    from farhand.common.scenario.section import NoSettings as NoSettings
    from farhand.common.scenario.section import Section as Section
    from farhand.common.scenario.section import own_settings as own_settings
    from farhand.common.shapes.box import Box as Box
    from farhand.common.shapes.capsule import Capsule as Capsule
    from farhand.common.shapes.mesh import Mesh as Mesh
    from farhand.common.shapes.plane import Plane as Plane
    from farhand.common.shapes.sphere import Sphere as Sphere
    from farhand.laboratory.replay import Replay as Replay
    from farhand.laboratory.replay import replay as replay
    from farhand.laboratory.simulation import SimulationResult as SimulationResult
    from farhand.laboratory.simulation import simulate as simulate
    from farhand.laboratory.simulation import simulate_run as simulate_run
    from farhand.netem.impairments.base import Impairment as Impairment
    from farhand.netem.impairments.base import ImpairmentContext as ImpairmentContext
    from farhand.netem.impairments.base import LossModel as LossModel
    from farhand.netem.impairments.base import Scope as Scope
    from farhand.netem.impairments.base import Stage as Stage
    from farhand.netem.impairments.base import Transit as Transit
    from farhand.netem.impairments.base import Word as Word
    from farhand.netem.impairments.delay import DelayWord as DelayWord
    from farhand.netem.recordings.formats.base import TraceFormat as TraceFormat
    from farhand.netem.recordings.formats.base import TraceOptions as TraceOptions
    from farhand.netem.recordings.formats.base import TraceSamples as TraceSamples
    from farhand.netem.recordings.formats.base import TraceText as TraceText
    from farhand.netem.recordings.trace import Trace as Trace
    from farhand.netem.recordings.trace import load_trace as load_trace
    from farhand.netem.spec import Spec as Spec
    from farhand.netem.spec import parse_spec as parse_spec
    from farhand.netem.words.reader import SpecReader as SpecReader
    from farhand.netem.words.reader import milliseconds_text as milliseconds_text
    from farhand.operator_side.control.controller import Controller as Controller
    from farhand.operator_side.control.controller import ControlProblem as ControlProblem
    from farhand.operator_side.control.controller import ControlSolution as ControlSolution
    from farhand.operator_side.control.controller import Status as Status
    from farhand.operator_side.control.registry import CONTROLLERS as CONTROLLERS
    from farhand.operator_side.control.registry import make_controller as make_controller
    from farhand.operator_side.control.settings import ControllerSettings as ControllerSettings
    from farhand.operator_side.margins.law import Margin as Margin
    from farhand.operator_side.margins.law import MarginInput as MarginInput
    from farhand.operator_side.margins.law import MarginLaw as MarginLaw
    from farhand.operator_side.margins.registry import MARGINS as MARGINS
    from farhand.operator_side.margins.settings import MarginSettings as MarginSettings
    from farhand.operator_side.operator_node import OperatorNode as OperatorNode
    from farhand.operator_side.prediction.law import Known as Known
    from farhand.operator_side.prediction.law import Prediction as Prediction
    from farhand.operator_side.prediction.law import StatePredictor as StatePredictor
    from farhand.operator_side.prediction.registry import PREDICTORS as PREDICTORS
    from farhand.operator_side.settings import OperatorSettings as OperatorSettings
    from farhand.operator_side.steering.device import SteeringDevice as SteeringDevice
    from farhand.operator_side.steering.device import SteeringInput as SteeringInput
    from farhand.operator_side.steering.device import View as View
    from farhand.operator_side.steering.registry import DEVICES as DEVICES
    from farhand.robot_side.robot_node import RobotNode as RobotNode
    from farhand.robot_side.robots.registry import ROBOTS as ROBOTS
    from farhand.robot_side.robots.registry import make_robot as make_robot
    from farhand.robot_side.robots.robot import Robot as Robot
    from farhand.robot_side.robots.robot import RobotSample as RobotSample
    from farhand.robot_side.robots.settings import RobotScenario as RobotScenario
    from farhand.robot_side.robots.settings import RobotSettings as RobotSettings
    from farhand.robot_side.safety.settings import SafetySettings as SafetySettings
    from farhand.robot_side.scene.surroundings import Surroundings as Surroundings
    from farhand.runs.run import Run as Run
    from farhand.runs.scenario import Scenario as Scenario
    from farhand.runs.scenario import load_scenario as load_scenario
    from farhand.runs.scenario import parse_scenario as parse_scenario
    from farhand.runs.scenario import replace_setting as replace_setting
    from farhand.runs.scenario import replace_settings as replace_settings
    from farhand.runs.summary import RunSummary as RunSummary
    from farhand.trials.leaderboard.methods.method import METHODS as METHODS
    from farhand.trials.leaderboard.methods.method import Method as Method

_HOME = {
    "FarhandError": "common.errors",
    "ScenarioError": "common.errors",
    "InputError": "common.errors",
    "Twist": "common.geometry",
    "Packet": "common.link.link",
    "Vector3": "common.messages.base",
    "VelocityCommand": "common.messages.command",
    "ControlReport": "common.messages.report",
    "Obstacle": "common.messages.scene",
    "Scene": "common.messages.scene",
    "RobotState": "common.messages.state",
    "NoSettings": "common.scenario.section",
    "Section": "common.scenario.section",
    "own_settings": "common.scenario.section",
    "Box": "common.shapes.box",
    "Capsule": "common.shapes.capsule",
    "Mesh": "common.shapes.mesh",
    "Plane": "common.shapes.plane",
    "Sphere": "common.shapes.sphere",
    "Surroundings": "robot_side.scene.surroundings",
    "SimulationResult": "laboratory.simulation",
    "simulate": "laboratory.simulation",
    "simulate_run": "laboratory.simulation",
    "Impairment": "netem.impairments.base",
    "ImpairmentContext": "netem.impairments.base",
    "LossModel": "netem.impairments.base",
    "Scope": "netem.impairments.base",
    "Stage": "netem.impairments.base",
    "Transit": "netem.impairments.base",
    "Word": "netem.impairments.base",
    "DelayWord": "netem.impairments.delay",
    "TraceFormat": "netem.recordings.formats.base",
    "TraceOptions": "netem.recordings.formats.base",
    "TraceSamples": "netem.recordings.formats.base",
    "TraceText": "netem.recordings.formats.base",
    "SpecReader": "netem.words.reader",
    "milliseconds_text": "netem.words.reader",
    "Trace": "netem.recordings.trace",
    "load_trace": "netem.recordings.trace",
    "Spec": "netem.spec",
    "parse_spec": "netem.spec",
    "Controller": "operator_side.control.controller",
    "ControlProblem": "operator_side.control.controller",
    "ControlSolution": "operator_side.control.controller",
    "Status": "operator_side.control.controller",
    "Margin": "operator_side.margins.law",
    "MarginInput": "operator_side.margins.law",
    "MarginLaw": "operator_side.margins.law",
    "Known": "operator_side.prediction.law",
    "Prediction": "operator_side.prediction.law",
    "StatePredictor": "operator_side.prediction.law",
    "ControllerSettings": "operator_side.control.settings",
    "MarginSettings": "operator_side.margins.settings",
    "OperatorSettings": "operator_side.settings",
    "SteeringDevice": "operator_side.steering.device",
    "SteeringInput": "operator_side.steering.device",
    "View": "operator_side.steering.device",
    "make_controller": "operator_side.control.registry",
    "OperatorNode": "operator_side.operator_node",
    "RobotNode": "robot_side.robot_node",
    "make_robot": "robot_side.robots.registry",
    "Robot": "robot_side.robots.robot",
    "RobotSample": "robot_side.robots.robot",
    "RobotScenario": "robot_side.robots.settings",
    "RobotSettings": "robot_side.robots.settings",
    "SafetySettings": "robot_side.safety.settings",
    "Run": "runs.run",
    "Scenario": "runs.scenario",
    "load_scenario": "runs.scenario",
    "replace_setting": "runs.scenario",
    "RunSummary": "runs.summary",
    "Method": "trials.leaderboard.methods.method",
    "METHODS": "trials.leaderboard.methods.method",
    "CONTROLLERS": "operator_side.control.registry",
    "DEVICES": "operator_side.steering.registry",
    "MARGINS": "operator_side.margins.registry",
    "PREDICTORS": "operator_side.prediction.registry",
    "ROBOTS": "robot_side.robots.registry",
    "Replay": "laboratory.replay",
    "replay": "laboratory.replay",
    "replace_settings": "runs.scenario",
    "parse_scenario": "runs.scenario",
}
__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    """A public name, imported on its first use (PEP 562)."""
    home = _HOME.get(name)
    if home is None:
        raise AttributeError(f"module 'farhand' has no attribute {name!r}")
    found: object = getattr(importlib.import_module(f"farhand.{home}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(_HOME)
