"""The arm as data: kinematics, limits and shape, from URDF, SRDF and fitted capsules."""

import dataclasses
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.robot_side.arm.capsules import (
    CapsuleFile,
    FittedCapsule,
    LinkCapsule,
    read_capsules,
    segment_distance,
)
from farhand.robot_side.arm.catalogue import (
    ARMS,
    KnownArm,
    capsule_path,
    srdf_of,
    unknown_arm,
    urdf_of,
)
from farhand.robot_side.arm.description.finding import nearest
from farhand.robot_side.arm.description.srdf import Semantics, read_srdf
from farhand.robot_side.arm.description.urdf import Chain, read_urdf
from farhand.robot_side.arm.description.variants import bare_text
from farhand.robot_side.arm.stand_ins import STAND_INS, Part

MAX_ACCELERATION = 15.0
"""Of a joint of an arm whose file cannot say it (rad/s^2)."""


@dataclass(frozen=True, slots=True, eq=False)
class ArmModel:
    """A serial chain of n (6 or 7) revolute joints on a base that stands.

    Joint i turns by q_i about `axes[i]` in its own frame, which at q_i = 0 is placed in the frame of the joint before
    it by `R_parent_joint[i]`, `p_parent_joint[i]`; the first one's in base:

        T_base_i = T_base_(i-1) (R_parent_joint[i], p_parent_joint[i]) Rot(axes[i], q_i)
        T_base_tool = T_base_(n-1) (R_last_tool, p_last_tool)

    Attributes:
        name: short, for the wire: `ur5`.
        title: for people: `UR5`.
        urdf: text for physics: no visuals, meshes by absolute path, what moves beside the chain fixed.
        joint_names: n names.
        tool_frame: link whose frame is the tool's.
        home: (n,) rad.
        lower, upper: (n,) position limits (rad).
        max_velocity: (n,) rad/s.
        max_acceleration: (n,) rad/s^2.
        max_torque: (n,) N m.
        R_parent_joint: (n, 3, 3).
        p_parent_joint: (n, 3), m.
        axes: (n, 3) unit vectors.
        R_last_tool: (3, 3).
        p_last_tool: (3,), m.
        capsules: around the links, those of the base included.
        self_pairs: of indices of capsules that must stay apart.
        never_colliding: pairs of links whose contact means nothing in the simulation.
        stand_ins: for links whose capsules say nothing of each other, see stand_ins.py.
        stand_in_pairs: of indices that must stay apart as well: i of a capsule, -1 - i of a stand-in.
        elbow, wrist: indices of the joints at whose zero the arm is stretched, the wrist singular; -1: not known.
        reach: where it finds room, for people; empty: not known.
        holds_itself: its joints' controllers take gravity back before they are told anything else.
    """

    name: str
    title: str
    urdf: str
    joint_names: tuple[str, ...]
    tool_frame: str
    home: Array
    lower: Array
    upper: Array
    max_velocity: Array
    max_acceleration: Array
    max_torque: Array
    R_parent_joint: Array
    p_parent_joint: Array
    axes: Array
    R_last_tool: Array
    p_last_tool: Array
    capsules: tuple[LinkCapsule, ...]
    self_pairs: tuple[tuple[int, int], ...]
    never_colliding: frozenset[frozenset[str]]
    elbow: int = -1
    wrist: int = -1
    reach: str = ""
    holds_itself: bool = True
    stand_ins: tuple[LinkCapsule, ...] = ()
    stand_in_pairs: tuple[tuple[int, int], ...] = ()

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @property
    def longest_reach(self) -> float:
        """No point of the tool frame is farther from the first joint (m)."""
        lengths = np.linalg.norm(self.p_parent_joint[1:], axis=1)
        return float(np.sum(lengths) + np.linalg.norm(self.p_last_tool))

    def poses(self, q: Array) -> tuple[Array, Array]:
        """Rotations (n, 3, 3) and origins (n, 3) of the joints' frames in base at q (n,): plain, for reference."""
        R, p = np.eye(3), np.zeros(3)
        rotations, origins = np.empty((self.n, 3, 3)), np.empty((self.n, 3))
        for i, angle in enumerate(q):
            p = p + R @ self.p_parent_joint[i]
            R = R @ self.R_parent_joint[i] @ _turn(self.axes[i], float(angle))
            rotations[i], origins[i] = R, p
        return rotations, origins

    def tool_pose(self, q: Array) -> tuple[Array, Array]:
        """Rotation (3, 3) and position (3,) of the tool in base at q (n,)."""
        rotations, origins = self.poses(q)
        return rotations[-1] @ self.R_last_tool, origins[-1] + rotations[-1] @ self.p_last_tool

    def self_gaps(self, q: Array) -> Array:
        """(m,) gap of each pair of capsules that is kept apart, at q (n,); negative: they overlap (m)."""
        ends = self.segments(q)
        return np.array(
            [
                segment_distance(*ends[i], *ends[j]) - self.capsules[i].radius - self.capsules[j].radius
                for i, j in self.self_pairs
            ]
        )

    def segments(self, q: Array) -> Array:
        """(m, 2, 3) ends of the capsules' segments in base at q (n,), m."""
        rotations, origins = self.poses(q)
        ends = np.array([(capsule.a, capsule.b) for capsule in self.capsules]).reshape(-1, 2, 3)
        for index, capsule in enumerate(self.capsules):
            if capsule.joint >= 0:
                ends[index] = ends[index] @ rotations[capsule.joint].T + origins[capsule.joint]
        return ends


@cache
def model(name: str) -> ArmModel:
    """A known arm by name; raises InputError."""
    known = ARMS.get(name)
    if known is None:
        raise InputError(f"{name!r}: {unknown_arm(name)}")
    chain, semantics = read_known(known)
    built = assemble(chain, known.tool_frame, semantics.never_colliding, read_capsules(capsule_path(name)))
    stand_ins, pairs = stood_in(built, name)
    return dataclasses.replace(
        built,
        name=name,
        title=known.title,
        home=np.array(known.home),
        max_acceleration=np.array(known.max_acceleration),
        elbow=known.elbow,
        wrist=known.wrist,
        reach=known.reach,
        holds_itself=known.holds_itself,
        stand_ins=stand_ins,
        stand_in_pairs=pairs,
    )


def stood_in(arm: ArmModel, name: str) -> tuple[tuple[LinkCapsule, ...], tuple[tuple[int, int], ...]]:
    """Stand-ins of a known arm, and their pairs; see ArmModel."""
    joints = {each.part: each.joint for each in arm.capsules}
    shapes: list[LinkCapsule] = []
    pairs: list[tuple[int, int]] = []

    def add(part: Part) -> int:
        a, b = np.array(part.a), np.array(part.b)
        shapes.append(LinkCapsule(part.link, joints[part.link], a, b, part.radius))
        return -len(shapes)

    for each in STAND_INS.get(name, ()):
        index = add(each.part)
        if isinstance(each.against, Part):
            pairs.append((index, add(each.against)))
        else:
            pairs += [(index, i) for i, one in enumerate(arm.capsules) if one.part == each.against]
    return tuple(shapes), tuple(pairs)


def read_known(known: KnownArm) -> tuple[Chain, Semantics]:
    """What the files of a known arm say."""
    return read_urdf(urdf_of(known), known.tool_frame), read_srdf(srdf_of(known))


def assemble(
    chain: Chain, tool_frame: str, never_colliding: frozenset[frozenset[str]], fitted: CapsuleFile
) -> ArmModel:
    """The model of a chain, at home in the middle of its joints' limits.

    Args:
        chain: from a URDF.
        tool_frame: link.
        never_colliding: pairs of links whose contact means nothing.
        fitted: capsules; a link that they name must be in the URDF.
    """
    import pinocchio as pin  # here, as those who only ask what an arm is need none

    try:
        pinocchio = pin.buildModelFromXML(bare_text(chain.text))
    except (ValueError, RuntimeError) as error:
        raise InputError(f"URDF of {chain.name!r}: {error}") from None
    joints = [pinocchio.getJointId(name) for name in chain.joint_names]
    if joints != list(range(1, pinocchio.njoints)):
        raise InputError(f"URDF of {chain.name!r}: its joints are no single chain")
    placements = [pinocchio.jointPlacements[joint] for joint in joints]
    tool = pinocchio.frames[pinocchio.getFrameId(tool_frame)]
    capsules = tuple(_in_joint_frame(pinocchio, each) for each in fitted.capsules)
    apart = never_colliding | {frozenset(pair) for pair in fitted.overlapping}
    return ArmModel(
        name=chain.name,
        title=chain.name,
        urdf=chain.text,
        joint_names=chain.joint_names,
        tool_frame=tool_frame,
        home=(chain.lower + chain.upper) / 2.0,
        lower=chain.lower,
        upper=chain.upper,
        max_velocity=chain.max_velocity,
        max_acceleration=np.full(len(joints), MAX_ACCELERATION),
        max_torque=chain.max_torque,
        R_parent_joint=np.array([placement.rotation for placement in placements]),
        p_parent_joint=np.array([placement.translation for placement in placements]),
        axes=_axes(pinocchio),
        R_last_tool=tool.placement.rotation.copy(),
        p_last_tool=tool.placement.translation.copy(),
        capsules=capsules,
        self_pairs=pairs_to_keep_apart(capsules, apart),
        never_colliding=never_colliding,
    )


def pairs_to_keep_apart(
    capsules: Sequence[LinkCapsule], never: Iterable[frozenset[str]]
) -> tuple[tuple[int, int], ...]:
    """Pairs of capsules that move against each other, without the pairs of parts in `never`."""
    excluded = frozenset(never)
    return tuple(
        (i, j)
        for i, one in enumerate(capsules)
        for j, other in enumerate(capsules)
        if i < j and one.joint != other.joint and frozenset((one.part, other.part)) not in excluded
    )


def _in_joint_frame(pinocchio: Any, fitted: FittedCapsule) -> LinkCapsule:
    if not pinocchio.existBodyName(fitted.link):
        links = [frame.name for frame in pinocchio.frames if pinocchio.existBodyName(frame.name)]
        raise InputError(f"capsules: link {fitted.link!r}: no such link; {nearest(fitted.link, links)}")
    frame = pinocchio.frames[pinocchio.getBodyId(fitted.link)]
    a, b = (frame.placement.act(np.array(end)) for end in (fitted.a, fitted.b))
    return LinkCapsule(fitted.link, frame.parentJoint - 1, a, b, fitted.radius)


def _axes(pinocchio: Any) -> Array:
    """(n, 3): what each joint turns about, in its own frame."""
    import pinocchio as pin

    data, q = pinocchio.createData(), pin.neutral(pinocchio)
    axes = [
        pin.computeJointJacobian(pinocchio, data, q, joint)[3:, joint - 1]
        for joint in range(1, pinocchio.njoints)
    ]
    return np.array(axes)


def _turn(axis: Array, angle: float) -> Array:
    """(3, 3) rotation by an angle (rad) about a unit vector."""
    x, y, z = axis
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * (across @ across)
    return turn
