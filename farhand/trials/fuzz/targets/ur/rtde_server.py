"""RTDE clients of the emulated controller."""

import struct
from collections.abc import Callable

from farhand.robot_side.ur.rtde_codec import DATA, INPUTS, OUTPUTS, START, URCONTROL, VERSION, pack
from farhand.trials.fuzz.target import Target, check
from farhand.trials.fuzz.ur_bench import Input, controller
from farhand.ur_emulator.rtde_server import RtdeHandler


def seeds() -> list[bytes]:
    """A conversation."""
    outputs = struct.pack(">d", 500.0) + b"timestamp,actual_q,robot_mode"
    inputs = b"input_int_register_24,input_double_register_24,speed_slider_mask,speed_slider_fraction"
    whole = (
        pack(VERSION, b"\0\2") + pack(URCONTROL) + pack(OUTPUTS, outputs) + pack(INPUTS, inputs) + pack(START)
    )
    return [whole, whole + pack(DATA, struct.pack(">BidId", 1, 7, 0.5, 1, 0.5)), pack(DATA, b"\1")]


def start() -> Callable[[bytes], None]:
    """See Target."""
    emulated = controller()

    def take(data: bytes) -> None:
        connection = Input(data)
        handler = RtdeHandler(connection, emulated, {})
        handler.poll(0.0)
        handler.cycle(0.0)
        check(len(connection.sent) < 1_000_000, "an answer without bounds")
        check(0.0 <= emulated.slider <= 1.0, "the slider is out of its bounds")
        check(not emulated.moves, "an arm moves without a program")

    return take


TARGET = Target(
    edge="RTDE at the emulated UR controller",
    promise="a client that errs is let go; nothing moves without a program",
    seeds=seeds,
    start=start,
)
