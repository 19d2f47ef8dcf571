"""What the robot says of itself while the doctor listens: is it one robot, and the one that the scenario means?"""

import threading
from collections.abc import Callable

import zenoh

from farhand.common.messages.base import Message
from farhand.common.messages.codec import Decoder
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.keys import description_key, scene_key, state_key
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.messages.twins import Twins
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.runs.difference import difference, scene_difference
from farhand.runs.scenario import Scenario
from farhand.site.findings import Finding

DESCRIPTION_TIME = 2.5
OVERLAP = 0.5


class Listening:
    """Hears a robot for as long as the `with` block lasts.

    Args:
        session: open.
        robot: the robot's name.

    Attributes:
        states: that arrived and could be read.
        decoder: of the states, for what it refused.
        twins: whether several robots of that name were heard.
        description, scene: the newest; None where none came.
    """

    def __init__(self, session: zenoh.Session, robot: str) -> None:
        self.states, self.decoder = 0, Decoder(RobotState)
        self.twins = False
        self.description: RobotDescription | None = None
        self.scene: Scene | None = None
        self._clock, self._twins = SystemClock(), Twins(to_ns(OVERLAP))
        self._complete = threading.Event()
        descriptions, scenes = Decoder(RobotDescription), Decoder(Scene)
        hears: list[tuple[str, Callable[[bytes], Message | None]]] = [
            (state_key(robot), self.decoder.decode),
            (description_key(robot), descriptions.decode),
            (scene_key(robot), scenes.decode),
        ]
        self._subscribers = [session.declare_subscriber(key, self._hearer(read)) for key, read in hears]

    def __enter__(self) -> "Listening":
        return self

    def __exit__(self, *_: object) -> None:
        for subscriber in self._subscribers:
            subscriber.undeclare()  # type: ignore[no-untyped-call]

    def wait_for_description(self, patience: float) -> None:
        """Until description and scene are there, at most `patience` s: they come once a second."""
        self._complete.wait(patience)

    def take(self, message: Message | None, now_ns: int) -> None:
        """Note what arrived."""
        if isinstance(message, RobotState):
            self.states += 1
            self._twins.note(message.session, now_ns)
            self.twins = self.twins or self._twins.there(now_ns)
        elif isinstance(message, RobotDescription):
            self.description = message
        elif isinstance(message, Scene):
            self.scene = message
        if self.description is not None and self.scene is not None:
            self._complete.set()

    def _hearer(self, read: Callable[[bytes], Message | None]) -> Callable[[zenoh.Sample], None]:
        return lambda sample: self.take(read(sample.payload.to_bytes()), self._clock.now_ns())


def judge_robot(heard: Listening, scenario: Scenario) -> list[Finding]:
    """Whether it is one robot, and how it differs from the scenario."""
    findings = []
    if heard.twins:
        remedy = "end one of them, or give it another name (`farhand robot --robot`)"
        findings.append(Finding("bad", "one robot", "two robots of this name send states", remedy))
    differs = []
    if heard.description is not None:
        differs.append(difference(heard.description, scenario))
    if heard.scene is not None:
        differs.append(scene_difference(heard.scene, scenario))
    remedy = "give the operator and the robot the same --scenario and --set; what the robot says is in force"
    findings += [Finding("note", "scenario", line, remedy) for line in differs if line]
    if differs and not any(differs):
        findings.append(Finding("good", "scenario", f"the robot is the one of {scenario.name}"))
    return findings
