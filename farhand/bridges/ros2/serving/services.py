"""The services: an emergency stop, an acknowledgement, a pause, and the one kind of command that there is."""

from collections.abc import Callable

from farhand.bridges.ros2.graph.node import RosNode, ServiceCall
from farhand.common.timing.handoff import Handoff

TRIGGER, SET_BOOL, COMMAND_TYPE = (
    "std_srvs/srv/Trigger",
    "std_srvs/srv/SetBool",
    "moveit_msgs/srv/ServoCommandType",
)
TWIST = 1
WAITING = 8
CLOSING_TIME = 0.5
Asked = Callable[[], tuple[bool, str]]
"""Does it, waits for what becomes of it, and says so in words."""


class Services:
    """Each that waits has a thread of its own, so that an emergency stop never stands behind anything.

    Args:
        node: serves.
        estop: stops the robot for good.
        acknowledge: clears a stop.
        pause: called with whether all steering from ROS is to be held; must not wait; None: nothing steers here.
        tell: takes a line for people; must not wait.
    """

    def __init__(self, node: RosNode, estop: Asked, acknowledge: Asked, pause: Callable[[bool], None] | None,
                 tell: Callable[[str], None]) -> None:  # fmt: skip
        self._tell, self._pause = tell, pause
        self._waiting: list[Handoff[ServiceCall]] = []
        for name, asked in (("estop", estop), ("acknowledge", acknowledge)):
            self._answers(node, name, asked)
        if pause is not None:
            node.serve("~/pause_servo", SET_BOOL, self._set_pause, tell)
            node.serve("~/switch_command_type", COMMAND_TYPE, self._switch, tell)

    def close(self) -> None:
        """Answer what waits, briefly."""
        for each in self._waiting:
            each.close(CLOSING_TIME)

    def _answers(self, node: RosNode, name: str, asked: Asked) -> None:
        def work(call: ServiceCall) -> None:
            done, words = asked()
            self._tell(f"~/{name}: {words}")
            call.answer(success=done, message=words)

        queue: Handoff[ServiceCall] = Handoff(work, f"ros2-{name}", WAITING)
        self._waiting.append(queue)

        def take(call: ServiceCall) -> None:
            if not queue.put(call):
                call.answer(success=False, message=f"{WAITING} requests are waiting; ask again later")

        node.serve(f"~/{name}", TRIGGER, take, self._tell)

    def _set_pause(self, call: ServiceCall) -> None:
        assert self._pause is not None
        pauses = bool(call.request.data)
        self._pause(pauses)
        words = "paused" if pauses else "goes on; let go and press anew"
        self._tell(f"~/pause_servo: {words}")
        call.answer(success=True, message=words)

    def _switch(self, call: ServiceCall) -> None:
        """There are twists, and no others."""
        call.answer(success=int(call.request.command_type) == TWIST)
