"""What SRDF files say of an arm."""

from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.robot_side.arm.description.srdf import read_srdf
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, check, finite, one_line

JOINTS = tuple(f"j{n}" for n in range(6))


def seeds() -> list[bytes]:
    """Two configurations, pairs that never touch, an end effector."""
    ready, folded = (
        f'<group_state name="{name}" group="arm">'
        + "".join(f'<joint name="{joint}" value="{value}"/>' for joint in JOINTS)
        + "</group_state>"
        for name, value in (("ready", 0.5), ("folded", -1.57))
    )
    pairs = "".join(
        f'<disable_collisions link1="l{n}" link2="l{n + 1}" reason="Adjacent"/>' for n in range(6)
    )
    effector = '<end_effector name="hand" parent_link="l6" group="hand"/>'
    return [f'<?xml version="1.0"?><robot name="arm">{ready}{folded}{effector}{pairs}</robot>'.encode()]


def start() -> Callable[[bytes], None]:
    """See Target."""
    path = scratch("arm.srdf")

    def take(data: bytes) -> None:
        path.write_bytes(data)
        try:
            said = read_srdf(path)
        except InputError as error:
            one_line(error)
            return
        check(finite(list(said.states)), "a configuration that is not finite")
        home = said.home(JOINTS)
        check(home is None or home.shape == (len(JOINTS),), "a home of another arm")

    return take


TARGET = Target(
    edge="SRDF",
    promise="a refusal is one line; configurations are finite",
    seeds=seeds,
    start=start,
    shape="text",
)
