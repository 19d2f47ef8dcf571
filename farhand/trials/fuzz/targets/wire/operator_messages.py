"""States, scenes and descriptions at the operator's side, and the further kinds that programs decode."""

import math
from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.link.link import Packet
from farhand.common.messages.base import Echo, Message
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.keys import description_key, scene_key, state_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.state import RobotState
from farhand.common.shapes.box import Box
from farhand.common.shapes.mesh import Mesh
from farhand.operator_side.sensing.perception import Perception
from farhand.operator_side.sensing.round_trip import RoundTrip
from farhand.trials.fuzz.target import Target, check, finite

NOW_NS = 5_000_000_000
CORNERS = ((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.2))
KEYS = (state_key("r"), scene_key("r"), description_key("r"))
HEADS: dict[str, Any] = {"source": "r", "session": 1_000_009, "seq": 40, "t_sent_ns": 900_000_000}


def state(**fields: Any) -> RobotState:
    """A robot on its way."""
    made: dict[str, Any] = {
        "echo": Echo(1_000_007, 5, NOW_NS - 60_000_000, 10_000_000),
        "t_sample_ns": 900_000_000,
        "position": (0.6, 0.0, 0.6),
        "velocity": (0.1, 0.0, 0.0),
        "applied_session": 1_000_007,
        "applied_seq": 5,
        "applied_for_ns": 20_000_000,
        "mode": "run",
        "holder": 1_000_007,
        "holder_name": "operator",
        "clearance": 1.0,
        "min_clearance": 1.0,
        "refused": {"stale": 1},
    }
    return RobotState(**(HEADS | made | fields))


def scene(**fields: Any) -> Scene:
    """A ball, a box and a mesh, and a target."""
    obstacles = (
        Obstacle("ball", (2.0, 0.0, 1.0), 0.3),
        Obstacle("box", (2.0, 1.0, 1.0), shape=Box((0.2, 0.2, 0.2))),
        Obstacle("mesh", (2.0, -1.0, 1.0), shape=Mesh(CORNERS)),
    )
    made: dict[str, Any] = {
        "t_sample_ns": 900_000_000, "obstacles": obstacles, "targets": ((4.0, 0.0, 3.0),)
    }  # fmt: skip
    return Scene(**(HEADS | made | fields))


def description(**fields: Any) -> RobotDescription:
    """A point."""
    made: dict[str, Any] = {
        "kind": "point", "lag": 0.1, "radius": 0.18, "rate_hz": 50.0, "state_rate_hz": 50.0, "max_speed": 2.0,
        "max_age": 1.0, "command_timeout": 0.3,
    }  # fmt: skip
    return RobotDescription(**(HEADS | made | fields))


def seeds() -> list[bytes]:
    """One of each kind behind the number of its key."""
    picture = CameraFrame(**HEADS, camera="c", width=320, height=240, jpeg=b"\xff\xd8\xff\xd9")
    bodies: list[Message] = [state(), scene(), description(), picture]
    pairs = [(number, msgspec.msgpack.encode(body)) for number, body in enumerate(bodies)]
    told = msgspec.msgpack.encode(report())
    return [bytes([number]) + body for number, body in (*pairs, (4, told))]


def report() -> ControlReport:
    """Of a tick in which nothing has come yet."""
    numbers = dict.fromkeys(
        ("prediction_error", "sigma", "inflation", "loss", "age", "state_age", "solve_time", "state_rate"),
        0.0,
    )
    counts = dict.fromkeys(
        ("tick", "target_index", "target_count", "refused_here", "refused_there", "stops", "overruns"), 0
    )
    vectors = dict.fromkeys(("desired", "filtered", "position", "predicted"), (0.0, 0.0, 0.0))
    nothing = dict.fromkeys(("rtt", "rtt_mean", "rtt_std", "clearance", "min_clearance", "safety"))
    said: dict[str, Any] = {"mode": "run", "intervening": False, "status": "idle"}
    return ControlReport(**(HEADS | numbers | counts | vectors | nothing | said))


def start() -> Callable[[bytes], None]:
    """See Target."""
    others: list[Decoder[Any]] = [Decoder(CameraFrame), Decoder(ControlReport)]

    def take(data: bytes) -> None:
        kind = data[0] % 5 if data else 0
        if kind >= 3:
            message: Any = others[kind - 3].decode(data[1:])
            check(message is None or finite(msgspec.to_builtins(message)), "a number is not finite")
            return
        perception, trips = Perception("r"), RoundTrip(1_000_007, 20)
        trips.sent(5, NOW_NS - 60_000_000)
        found = perception.take(Packet(KEYS[kind], data[1:], NOW_NS))
        if found is not None:
            trips.received(found, NOW_NS)
            check(trips.newest is None or math.isfinite(trips.newest), "a round trip is not finite")
        for message in (perception.state, perception.scene, perception.description):
            check(message is None or finite(msgspec.to_builtins(message)), "a number is not finite")

    return take


TARGET = Target(
    edge="states, scenes, descriptions, pictures and reports: codec, perception",
    promise="no number that is not finite comes through",
    seeds=seeds,
    start=start,
    shape="map",
    head=1,
    longest=8192,
)
