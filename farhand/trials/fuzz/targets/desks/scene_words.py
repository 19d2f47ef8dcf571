"""The operator's program is asked for a change of the scene by a command on its host, and passes on what it read."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import msgspec

from farhand.common.link.link import Link, Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.scene import Scene, SceneAnswer
from farhand.common.messages.scene_request import SceneRequest
from farhand.common.messages.state import RobotState
from farhand.common.timing.clock import to_ns
from farhand.site.scene import PATIENCE, SceneServer
from farhand.site.scene_asking import Change
from farhand.trials.fuzz.target import Target, check, one_line
from farhand.trials.fuzz.targets.wire.scene_requests import COMING, ROBOT, THERE

if TYPE_CHECKING:
    from farhand.operator_side.operator_node import OperatorNode

NOW_NS = 5_000_000_000
HEADS: dict[str, Any] = {
    "source": "r",
    "session": ROBOT,
    "seq": 7,
    "t_sent_ns": NOW_NS,
    "t_sample_ns": NOW_NS,
}
SCENE = Scene(**HEADS, obstacles=THERE, revision=4)
STATE = RobotState(
    **HEADS, position=(0.0, 0.0, 0.5), velocity=(0.0, 0.0, 0.0), clearance=0.2, min_clearance=0.2
)


class _Asked:
    """A request that keeps what it was answered."""

    def __init__(self, payload: bytes) -> None:
        self.payload = payload
        self.answers: list[bytes] = []

    def reply(self, answer: bytes) -> None:
        self.answers.append(answer)


def seeds() -> list[bytes]:
    """The words of `farhand scene set`, `add` and `remove`."""
    ball, shuttle, wedge = COMING
    changes = (
        Change("add", (ball,)),
        Change("set", (shuttle, wedge)),
        Change("set"),
        Change("remove", gone=("post", "kitchen")),
    )
    return list(map(msgspec.msgpack.encode, changes))


def start() -> Callable[[bytes], None]:
    """See Target."""
    decoder = Decoder(SceneRequest)

    def take(data: bytes) -> None:
        sent: list[Packet] = []
        node = SimpleNamespace(who=SimpleNamespace(name="alice"), scene=SCENE, state=STATE)
        server = _server(node, sent)
        asked, other = _Asked(data), _Asked(data)
        server.look(asked, NOW_NS)  # type: ignore[arg-type]
        if not sent:
            check(len(asked.answers) == 1, "neither passed on nor refused")
            _refused(asked)
            return
        server.look(other, NOW_NS)  # type: ignore[arg-type]
        _refused(other)
        request = decoder.decode(sent[0].payload)
        check(request is not None, "what is passed on is no request")
        assert request is not None
        check(request.base == SCENE.changes, "a change of another revision")
        check(request.echo is not None and request.echo.t_sent_ns == STATE.t_sent_ns, "built on no state")
        said = msgspec.msgpack.decode(data)
        check(said["deed"] == request.deed, "another deed than was asked for")
        answer = SceneAnswer(session=request.session, settled=True, refusal="no" if len(data) % 2 else "")
        node.scene = msgspec.structs.replace(SCENE, answers=(answer,))
        server.look(None, NOW_NS + to_ns(PATIENCE))
        check(len(asked.answers) == 1, "the robot has answered, and nobody is told")
        check(bool(msgspec.json.decode(asked.answers[0])["ok"]) != bool(answer.refusal), "told the opposite")

    return take


def _server(node: SimpleNamespace, sent: list[Packet]) -> SceneServer:
    """Its beginning opens a Zenoh session and a thread; what reads needs neither."""
    server = SceneServer.__new__(SceneServer)
    server._node, server._pending, server._robot = cast("OperatorNode", node), [], "r"
    server._say, server._link = _shown, cast("Link", SimpleNamespace(send=sent.append))
    return server


def _shown(said: str) -> None:
    """What is shown to people."""
    one_line(ValueError(said))


def _refused(asked: _Asked) -> None:
    check(len(asked.answers) == 1, "refused not once")
    told = msgspec.json.decode(asked.answers[0])
    check(told["ok"] is False, "refused, and told the opposite")
    one_line(ValueError(told["error"]))


TARGET = Target(
    edge="words of `farhand scene`, at the operator's program",
    promise="passed on as the same deed, on the newest state and revision, or refused in one line; answered once",
    seeds=seeds,
    start=start,
    shape="map",
    longest=8192,
)
