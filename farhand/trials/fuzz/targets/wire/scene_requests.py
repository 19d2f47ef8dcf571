"""A robot with two obstacles is asked for another scene: what changes it must be fresh, new, and make sense."""

from collections.abc import Callable, Sequence
from typing import Any

import msgspec

from farhand.common.link.link import Packet
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import scene_request_key
from farhand.common.messages.scene import MAX_OBSTACLES, Obstacle
from farhand.common.messages.scene_request import MOST_MOVERS, SceneRequest
from farhand.common.shapes.box import Box
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.safety.scene_intake import SceneIntake
from farhand.robot_side.safety.settings import SafetySettings
from farhand.robot_side.scene.obstacle_field import ObstacleField
from farhand.trials.fuzz.target import Target, check, finite

ROBOT, NOW_NS = 1_000_009, 5_000_000_000
KEY = scene_request_key("r")
TOOL, RADIUS = (0.0, 0.0, 0.5), 0.05
THERE = (
    Obstacle(id="post", position=(0.5, 0.0, 0.3), shape=Sphere(0.1)),
    Obstacle(id="mover", position=(0.5, 0.5, 0.3), shape=Box((0.1, 0.1, 0.1)), velocity=(0.0, -0.1, 0.0)),
)
CORNERS = ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1))
PATH = ((0.0, 0.6, 0.2), (0.4, 0.6, 0.2))
COMING = (
    Obstacle(id="ball", position=(0.0, 0.6, 0.2), shape=Sphere(0.05), velocity=(0.1, 0.0, 0.0)),
    Obstacle(id="s", position=PATH[0], shape=Sphere(0.05), path=PATH, speed=0.2, acceleration=1.0),
    Obstacle(id="wedge", position=(0.3, 0.3, 0.1), shape=Mesh(CORNERS)),
)


def request(age_ns: int = 50_000_000, **fields: Any) -> bytes:
    """A request's bytes, without the checksum, which a mutation would break."""
    made: dict[str, Any] = {
        "source": "alice",
        "session": 1_000_007,
        "seq": 1,
        "t_sent_ns": 9,
        "echo": Echo(ROBOT, 3, NOW_NS - age_ns, 1_000_000),
        "deed": "add",
        "base": 0,
    }
    return msgspec.msgpack.encode(SceneRequest(**(made | fields)))


def seeds() -> list[bytes]:
    """Good ones, and one of each kind that is refused."""
    ball, shuttle, wedge = COMING
    whole = SceneRequest(
        source="alice", session=3, seq=1, t_sent_ns=9, echo=Echo(ROBOT, 3, NOW_NS, 0), deed="set", base=0,
        obstacles=(ball,),
    )  # fmt: skip
    return [
        request(obstacles=(ball,)),
        request(deed="set", obstacles=(shuttle, ball)),
        request(deed="set", obstacles=(wedge,)),
        request(deed="set"),
        request(deed="remove", gone=("post",)),
        request(deed="remove", gone=("kitchen",)),
        request(obstacles=(THERE[0],)),
        request(obstacles=(ball, ball)),
        request(base=1, obstacles=(ball,)),
        request(obstacles=(Obstacle(id="on", position=TOOL, shape=Sphere(0.05)),)),
        request(age_ns=2_000_000_000, obstacles=(ball,)),
        request(echo=None, obstacles=(ball,)),
        encode(whole),
    ]


def start() -> Callable[[bytes], None]:
    """See Target."""

    def take(data: bytes) -> None:
        intake = SceneIntake("r", SafetySettings(), ROBOT)
        intake.take([Packet(KEY, data, NOW_NS)])
        found = intake.judge(THERE, NOW_NS, _crowds) if intake.waits else None
        check(
            (intake.revision == 1) == (found is not None),
            "a change without a revision, or the other way round",
        )
        if found is None:
            check(bool(intake.refused), "neither obeyed nor refused")
            return
        _judge(found, data)

    return take


def _crowds(obstacles: Sequence[Obstacle]) -> str:
    """Why they cannot come: one would be on the robot, whose sphere stands at TOOL."""
    return "on the robot" if any(distance_to(each, TOOL) < RADIUS for each in obstacles) else ""


def _judge(found: tuple[Obstacle, ...], data: bytes) -> None:
    """By rules of its own, from the bytes alone; then as the robot's loop uses it."""
    said = msgspec.msgpack.decode(data)
    check(said["base"] == 0, "a change of another revision")
    check(said["echo"]["session"] == ROBOT, "changed for what was built on another robot's state")
    check(0 <= NOW_NS - said["echo"]["t_sent_ns"] <= 1_000_000_000, "changed by what is stale")
    check(len(found) <= MAX_OBSTACLES, "too many obstacles")
    check(sum(o.moves for o in found) <= MOST_MOVERS, "too many that move")
    check(len({o.id for o in found}) == len(found), "two obstacles of one name")
    come = [obstacle for obstacle in found if obstacle not in THERE]
    check(all(distance_to(each, TOOL) >= RADIUS for each in come), "one was put onto the robot")
    field = ObstacleField(found, NOW_NS)
    for seconds in (0, 10, 3600):
        then_ns = NOW_NS + seconds * 1_000_000_000
        check(finite(msgspec.to_builtins(field.at(then_ns))), "an obstacle goes where no number is finite")
        check(finite(field.table(then_ns).rows.tolist()), "a row is not finite")
        check(finite(field.clearance(TOOL, RADIUS, then_ns)), "a distance is not finite")


TARGET = Target(
    edge="requests to change the scene at the robot: codec, intake, obstacles",
    promise="changed only by what is fresh and of this revision, nothing put onto the robot; every place is finite",
    seeds=seeds,
    start=start,
    shape="map",
    longest=8192,
)
