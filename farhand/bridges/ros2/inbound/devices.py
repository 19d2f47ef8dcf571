"""The two steering devices of a ROS 2 graph, each a hand of its own: a stream of twists, and a joystick."""

from farhand.bridges.ros2.graph.node import Subscription
from farhand.bridges.ros2.inbound.arrivals import LATE, Arrivals
from farhand.bridges.ros2.inbound.reading import Reader, Refusals, RefusedError, TwistFrames, inputs_of
from farhand.bridges.ros2.inbound.twist_hand import TwistHand
from farhand.common.messages.steering import Steering
from farhand.operator_side.devices.hand import Hand, Obstacles
from farhand.operator_side.devices.reading import Reading
from farhand.operator_side.steering.hand.hand_settings import HandSettings


class TwistDevice:
    """Args:
    subscription: to the twists.
    reader: of them.
    frames: what their frames are called.
    hand: what they want.
    refusals: counts what counts for nothing.
    """

    def __init__(self, subscription: Subscription, reader: Reader, frames: TwistFrames, hand: TwistHand,
                 refusals: Refusals) -> None:  # fmt: skip
        self._subscription, self._reader, self._frames = subscription, reader, frames
        self._hand, self._refusals = hand, refusals

    @property
    def drives(self) -> bool:
        """Whether it keeps the wheel."""
        return self._hand.drives

    @property
    def says(self) -> str:
        """For people: what it waits for."""
        return self._hand.says

    def hear(self, now_ns: int) -> bool:
        """Take what has come; whether anything has."""
        heard = self._subscription.drain()
        for each in heard:
            try:
                attachment, message = self._reader.read(each)
                wanted = self._frames.wanted(message, attachment)
            except RefusedError as error:
                self._refusals.add(self._subscription.topic, error.reason, str(error), now_ns)
                if error.attachment is not None:
                    self._hand.refuse(error.attachment.gid)
                continue
            why = self._hand.hear(attachment.gid, attachment.seq, attachment.sent_ns, wanted, each.arrived_ns)
            if why:
                self._refusals.add(self._subscription.topic, why, f"a twist {why}", now_ns)
        return bool(heard)

    def wish(self, now_ns: int, obstacles: Obstacles) -> Steering:
        """What is wanted; nothing where something is in the way, and then only a fresh press wants anything."""
        if obstacles.lost or obstacles.stopped:
            self._hand.let_go()
        return self._hand.wish(now_ns)


class JoyDevice:
    """A Joy is read as any gamepad is: 0.1 s without one is an unplugged device, and only a fresh press drives again.

    Args:
        subscription: to the joystick.
        reader: of its messages.
        settings: what its axes and buttons do.
        refusals: counts what counts for nothing.
    """

    def __init__(
        self, subscription: Subscription, reader: Reader, settings: HandSettings, refusals: Refusals
    ) -> None:
        self._subscription, self._reader, self._refusals = subscription, reader, refusals
        self._hand, self._arrivals = Hand(settings, "joystick"), Arrivals()
        self._reading: Reading | None = None
        self._sender, self._plugged = b"", 1

    @property
    def drives(self) -> bool:
        """Whether it keeps the wheel."""
        return self._hand.drives

    @property
    def says(self) -> str:
        """For people: what it does, or waits for."""
        return (
            self._hand.says if self._reading is not None else f"nothing comes on {self._subscription.topic}"
        )

    def hear(self, now_ns: int) -> bool:
        """Take what has come; whether anything has."""
        heard = self._subscription.drain()
        for each in heard:
            try:
                attachment, message = self._reader.read(each)
                inputs = inputs_of(message, attachment)
            except RefusedError as error:
                self._refusals.add(self._subscription.topic, error.reason, str(error), now_ns)
                self._unplug()
                continue
            why = self._arrivals.judge(attachment.gid, attachment.seq, attachment.sent_ns, each.arrived_ns)
            if why == LATE:
                self._unplug()
            if why:
                self._refusals.add(self._subscription.topic, why, f"a message {why}", now_ns)
            else:
                self._take(attachment.gid, inputs, each.arrived_ns)
        return bool(heard)

    def wish(self, now_ns: int, obstacles: Obstacles) -> Steering:
        """What is wanted at `now_ns`."""
        return self._hand.feel(self._reading, now_ns, obstacles)

    def _take(self, sender: bytes, inputs: dict[str, float], arrived_ns: int) -> None:
        if sender != self._sender:
            self._sender = sender
            self._plugged += 1  # another joystick: what is held there was not pressed here
        self._reading = Reading(self._subscription.topic, self._plugged, inputs, arrived_ns)

    def _unplug(self) -> None:
        """What comes next is a device anew: only a fresh press drives."""
        self._plugged += 1
