"""Messages with sensible defaults; a test says only what it is about.

All builders take the sequence number first, since most tests count, and every field of the message as a keyword;
a field that does not exist is a TypeError. Stamps follow the sequence number at the usual rate of that message.
"""

from typing import Any

from farhand.common.messages.base import ZERO, Echo, Message, Vector3
from farhand.common.messages.command import CommandMode, VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.state import RobotState

OPERATOR_SESSION = 7
ROBOT_SESSION = 9
FORWARD: Vector3 = (0.1, 0.0, 0.0)

TICK_NS = 100_000_000
STATE_NS = 20_000_000
SCENE_NS = 1_000_000_000


def echo_of(message: Message, hold_ns: int = 0) -> Echo:
    """The echo that whoever received `message` sends back after having held it for `hold_ns`."""
    return Echo(message.session, message.seq, message.t_sent_ns, hold_ns)


def state(seq: int = 0, **fields: Any) -> RobotState:
    """A robot that stands at the origin in mode `run` with a metre of room; OPERATOR_SESSION has control."""
    stamp = fields.get("t_sent_ns", seq * STATE_NS)
    holder = fields.get("holder", OPERATOR_SESSION)
    defaults: dict[str, Any] = {
        "source": "r",
        "session": ROBOT_SESSION,
        "t_sent_ns": stamp,
        "t_sample_ns": stamp,
        "position": ZERO,
        "velocity": ZERO,
        "mode": "run",
        "holder": holder,
        "holder_name": "operator" if holder else "",
        "clearance": 1.0,
        "min_clearance": 1.0,
    }
    return RobotState(seq=seq, **(defaults | fields))


def obstacle(name: str = "ball", **fields: Any) -> Obstacle:
    """A ball of 0.1 m that stands a metre ahead; another `shape`, a `path` and all else are keywords."""
    defaults: dict[str, Any] = {}
    if "path" not in fields:
        defaults["position"] = (1.0, 0.0, 0.0)
    if "shape" not in fields:
        defaults["radius"] = 0.1
    return Obstacle(name, **(defaults | fields))


def scene(seq: int = 0, *obstacles: Obstacle, **fields: Any) -> Scene:
    """What is around the robot: these obstacles (none), and no target."""
    stamp = fields.get("t_sent_ns", seq * SCENE_NS)
    defaults: dict[str, Any] = {
        "source": "r",
        "session": ROBOT_SESSION,
        "t_sent_ns": stamp,
        "t_sample_ns": stamp,
        "obstacles": obstacles,
    }
    return Scene(seq=seq, **(defaults | fields))


def description(seq: int = 0, **fields: Any) -> RobotDescription:
    """A point of 0.1 m with a lag of 0.1 s, 50 ticks and states a second, that moves at 2 m/s at most."""
    defaults: dict[str, Any] = {
        "source": "r",
        "session": ROBOT_SESSION,
        "t_sent_ns": seq * SCENE_NS,
        "kind": "point",
        "lag": 0.1,
        "radius": 0.1,
        "rate_hz": 50.0,
        "state_rate_hz": 50.0,
        "max_speed": 2.0,
        "max_age": 1.0,
        "command_timeout": 0.3,
    }
    return RobotDescription(seq=seq, **(defaults | fields))


def command(seq: int = 0, mode: CommandMode = "run", **fields: Any) -> VelocityCommand:
    """A command of OPERATOR_SESSION: forward at 0.1 m/s with mode `run`, else zero; no plan, no echo."""
    defaults: dict[str, Any] = {
        "source": "operator",
        "session": OPERATOR_SESSION,
        "t_sent_ns": seq * TICK_NS,
        "velocity": FORWARD if mode == "run" else ZERO,
    }
    return VelocityCommand(seq=seq, mode=mode, **(defaults | fields))


def report(tick: int = 0, **fields: Any) -> ControlReport:
    """What an operator side reports that stands at the origin and has seen nothing yet."""
    defaults: dict[str, Any] = {
        "source": "operator",
        "session": OPERATOR_SESSION,
        "seq": tick,
        "t_sent_ns": tick * TICK_NS,
        "mode": "run",
        "desired": ZERO,
        "filtered": ZERO,
        "intervening": False,
        "position": ZERO,
        "predicted": ZERO,
        "prediction_error": 0.0,
        "sigma": 0.0,
        "inflation": 0.0,
        "rtt": None,
        "rtt_mean": None,
        "rtt_std": None,
        "loss": 0.0,
        "age": 0.0,
        "state_age": 0.0,
        "status": "idle",
        "solve_time": 0.0,
        "clearance": None,
        "min_clearance": None,
        "safety": None,
        "target_index": 0,
        "target_count": 0,
        "refused_here": 0,
        "refused_there": 0,
        "stops": 0,
        "state_rate": 0.0,
        "overruns": 0,
    }
    return ControlReport(tick=tick, **(defaults | fields))
