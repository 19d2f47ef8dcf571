"""What an SRDF says of an arm: links whose contact means nothing, named configurations, the end effector."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.robot_side.arm.description.xml import numbers, read_xml


@dataclass(frozen=True, slots=True)
class Semantics:
    """Attributes:
    never_colliding: pairs of links whose contact means nothing.
    states: each named configuration, joint by joint (rad).
    tool_frame: link that holds the end effector; empty: not said.
    """

    never_colliding: frozenset[frozenset[str]]
    states: tuple[dict[str, float], ...]
    tool_frame: str = ""

    def home(self, joint_names: tuple[str, ...]) -> Array | None:
        """The first named configuration that says where all of these joints are, (n,) rad."""
        for state in self.states:
            if all(name in state for name in joint_names):
                return np.array([state[name] for name in joint_names])
        return None


def read_srdf(path: Path) -> Semantics:
    """Read a file; raises InputError when it is no SRDF."""
    root = read_xml(path, "SRDF")
    if root.tag != "robot":
        raise InputError(f"SRDF {path}: is no SRDF: its root is <{root.tag}>, not <robot>")
    pairs = root.iter("disable_collisions")
    states = []
    try:
        for state in root.iter("group_state"):
            joints = state.findall("joint")
            states.append(
                {joint.get("name", ""): float(numbers(joint, "value", size=1)[0]) for joint in joints}
            )
    except InputError as error:
        raise InputError(f"SRDF {path}: group_state {state.get('name')!r}: {error}") from None
    effector = root.find("end_effector")
    return Semantics(
        never_colliding=frozenset(
            frozenset((pair.get("link1", ""), pair.get("link2", ""))) for pair in pairs
        ),
        states=tuple(states),
        tool_frame=effector.get("parent_link", "") if effector is not None else "",
    )
