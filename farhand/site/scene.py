"""`farhand scene`: what is around a robot that runs, and changes of it.

The robot alone decides, and says so in the scene that it announces. It is asked straight where it is heard, else
through an operator's program on its host; never both ways, since a change is obeyed once.
"""

import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import msgspec
import zenoh

from farhand.common.errors import InputError
from farhand.common.link.link import Link, Packet
from farhand.common.link.requests import Request, refusal
from farhand.common.messages.codec import Decoder
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import mirror_key, scene_change_key, scene_key, scene_request_key, state_key
from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.state import RobotState
from farhand.common.process.signals import say
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.common.timing.slot import Slot
from farhand.site.desk import OperatorDesk
from farhand.site.reach import Reached, reaching
from farhand.site.scene_asking import Asker, Change, SceneAsking, checked

if TYPE_CHECKING:
    from farhand.operator_side.operator_node import OperatorNode

PATIENCE = 6.0
"""s until the robot must have answered."""
STRAIGHT = 2.0
"""s until it must have been heard, before its operator's program is asked."""
AGAIN_AFTER = 0.1
UNCONFIRMED = "NOT CONFIRMED"
_MOST_BYTES = 1_000_000


class SceneServer(OperatorDesk):
    """The operator's half of `farhand scene`: one change at a time, over its own link to the robot.

    Args:
        node, slot, clock, session, robot, tell: see OperatorDesk.
        link: to the robot.
    """

    name = "scene"
    _asking: SceneAsking | None = None
    _begun_ns = _asked_ns = 0

    def __init__(
        self,
        node: "OperatorNode",
        slot: Slot,
        clock: SystemClock,
        session: zenoh.Session,
        robot: str,
        tell: Callable[[str], None],
        link: Link,
    ) -> None:
        self._robot, self._link = robot, link
        super().__init__(node, slot, clock, session, robot, tell)

    @staticmethod
    def key(robot: str) -> str:
        """See OperatorDesk."""
        return scene_change_key(robot)

    def look(self, request: Request | None, now_ns: int) -> None:
        """See OperatorDesk."""
        if request is not None:
            self._begin(request, now_ns)
        if self._asking is not None:
            self._follow(self._asking, now_ns)

    def _begin(self, request: Request, now_ns: int) -> None:
        if self._asking is not None:
            request.reply(refusal("another change of the scene is on its way; ask again"))
            return
        try:
            change = checked(msgspec.msgpack.decode(request.payload[:_MOST_BYTES], type=Change))
        except InputError as error:
            request.reply(refusal(str(error)))
            return
        except (msgspec.MsgspecError, ValueError, RecursionError, OverflowError) as error:
            request.reply(refusal(f"the request cannot be read: {error}"))
            return
        self._say(f"asks for a change of the scene, for `farhand scene {change.deed}`")
        self._pending.append(request)
        self._asking = SceneAsking(Asker(self._node.who.name, now_ns | 1), change)
        self._begun_ns, self._asked_ns = now_ns, 0

    def _follow(self, asking: SceneAsking, now_ns: int) -> None:
        asking.see(self._node.scene)
        if asking.done or now_ns - self._begun_ns > to_ns(PATIENCE - STRAIGHT - 0.5):
            self._asking = None
            why = outcome(asking, self._robot, (now_ns - self._begun_ns) * 1e-9)
            told = {"ok": True, "scene": _told(asking.scene)} if asking.scene is not None else {}
            self._answer(refusal(why) if why or not told else msgspec.json.encode(told))
        elif now_ns - self._asked_ns >= to_ns(AGAIN_AFTER):
            self._asked_ns = now_ns
            payload = asking.step(self._node.state, now_ns)
            if payload is not None:
                self._link.send(Packet(scene_request_key(self._robot), payload))


class _Heard:
    """The robot as it is heard over one session; told by Zenoh's threads."""

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self.session = session
        self.scene: Scene | None = None
        self.state: RobotState | None = None
        self.mirrored: Scene | None = None
        self._newest = {kind: Newest() for kind in ("scene", "state", "mirrored")}
        self._scenes, self._states = Decoder(Scene), Decoder(RobotState)
        session.declare_subscriber(scene_key(robot), lambda sample: self._take("scene", self._scenes, sample))
        session.declare_subscriber(state_key(robot), lambda sample: self._take("state", self._states, sample))
        session.declare_subscriber(
            mirror_key(robot, "scene"), lambda sample: self._take("mirrored", self._scenes, sample)
        )

    def _take(self, name: str, decoder: "Decoder[Scene] | Decoder[RobotState]", sample: zenoh.Sample) -> None:
        message = decoder.decode(sample.payload.to_bytes())
        if message is not None and self._newest[name].accept(message, 0):
            setattr(self, name, message)


def outcome(asking: SceneAsking, robot: str, seconds: float) -> str:
    """Why it is not known to be done after so long; empty: it is. A refusal that was not the last word is none."""
    if asking.done:
        return asking.refusal
    why = unanswered(asking, robot, seconds)
    return f"{why}; it had refused before: {asking.refusal}" if asking.refusal else why


def unanswered(asking: SceneAsking, robot: str, seconds: float) -> str:
    """What is known where no answer came: a request that was sent may have been obeyed."""
    if asking.asked:
        asked = f"{UNCONFIRMED}: {robot!r} was asked and has not answered in {seconds:g} s"
        return f"{asked}; look with `farhand scene list`"
    return f"no state of {robot!r} came in {seconds:g} s to ask it by"


def change_scene(robot: str, connect: Sequence[str], tls: str, router: bool, change: Change) -> int:
    """`farhand scene set|add|remove`: returns 0 once the robot has done it, 1 where it has not, which is said.

    Arguments and errors: see reach.reaching; InputError as well where no robot would look at the change.
    """
    clock, change = SystemClock(), checked(change)
    with reaching("scene", robot, connect, tls, router) as reached:
        heard = [_Heard(session, robot) for session in reached.sessions]
        asking = SceneAsking(Asker(reached.source, clock.now_ns() | 1), change)
        way = _straight_way(heard, clock)
        if way is not None:
            _pursue(asking, way, robot, clock)
            why = outcome(asking, robot, PATIENCE)
            scene = _told(asking.scene)
        else:
            why, scene = _through_operator(reached, robot, change)
    if why:
        say("scene", why if why.startswith(UNCONFIRMED) else f"NOT CHANGED: {why}")
        return 1
    print(f"{robot}: scene revision {scene['revision']}, {scene['obstacles']}")
    return 0


def hear_scene(robot: str, connect: Sequence[str], tls: str, router: bool) -> Scene | None:
    """The scene of a robot as it announces it; None where it is not heard. See reach.reaching."""
    clock, pause = SystemClock(), threading.Event()
    with reaching("scene", robot, connect, tls, router, commands=False) as reached:
        heard = [_Heard(session, robot) for session in reached.sessions]
        until_ns = clock.now_ns() + to_ns(PATIENCE)
        while clock.now_ns() < until_ns:
            for each in heard:
                found = each.scene or each.mirrored
                if found is not None:
                    return found
            pause.wait(AGAIN_AFTER)
    say("scene", f"nothing is heard of robot {robot!r} in {PATIENCE:g} s; tried {reached.tried}")
    return None


def _straight_way(heard: Sequence[_Heard], clock: SystemClock) -> _Heard | None:
    """The session over which the robot itself is heard."""
    begun_ns, pause = clock.now_ns(), threading.Event()
    patience = STRAIGHT
    while clock.now_ns() - begun_ns < to_ns(patience):
        for each in heard:
            if each.scene is not None and each.state is not None:
                return each
            if each.scene is not None or each.state is not None:
                patience = PATIENCE  # it is there, and a scene comes once a second only
        pause.wait(AGAIN_AFTER)
    return None


def _pursue(asking: SceneAsking, way: _Heard, robot: str, clock: SystemClock) -> None:
    until_ns, pause = clock.now_ns() + to_ns(PATIENCE), threading.Event()
    while clock.now_ns() < until_ns:
        asking.see(way.scene)
        if asking.done:
            return
        payload = asking.step(way.state, clock.now_ns())
        if payload is not None:
            way.session.put(
                scene_request_key(robot), payload, express=True, priority=zenoh.Priority.DATA_HIGH
            )
        pause.wait(AGAIN_AFTER)


def _through_operator(reached: Reached, robot: str, change: Change) -> tuple[str, dict[str, object]]:
    """Why its operator's program did not have it done, or the scene's revision and obstacles."""
    clock = SystemClock()
    for session in reached.sessions:
        asked_ns, key = clock.now_ns(), scene_change_key(robot)
        querier = session.declare_querier(key)
        heard = querier.matching_status.matching  # type: ignore[attr-defined]  # its stubs say bool
        querier.undeclare()  # type: ignore[no-untyped-call]
        for reply in session.get(key, payload=msgspec.msgpack.encode(change), timeout=PATIENCE):
            if reply.ok is None:
                continue
            found = msgspec.json.decode(reply.ok.payload.to_bytes())
            if found.get("ok"):
                return "", found["scene"]
            return str(found.get("error", "the request was refused")), {}
        if heard or clock.now_ns() - asked_ns > to_ns(0.5 * PATIENCE):
            return f"{UNCONFIRMED}: the operator's program of {robot!r} was asked and has not answered", {}
    return f"nothing is heard of robot {robot!r}, nor of its operator; tried {reached.tried}", {}


def _told(scene: Scene | None) -> dict[str, object]:
    obstacles: tuple[Obstacle, ...] = scene.obstacles if scene is not None else ()
    names = ", ".join(each.id for each in obstacles)
    revision = scene.changes if scene is not None else 0
    return {
        "revision": revision,
        "obstacles": f"{len(obstacles)} obstacles: {names}" if names else "no obstacle",
    }
