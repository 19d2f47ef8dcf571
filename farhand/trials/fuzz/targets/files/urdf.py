"""Robot descriptions."""

from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.robot_side.arm.description.urdf import read_urdf
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, check, one_line


def seeds() -> list[bytes]:
    """An arm of six joints without meshes."""
    links = "".join(f'<link name="l{n}"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>'
                    for n in range(7))  # fmt: skip
    joints = "".join(
        f'<joint name="j{n}" type="revolute"><parent link="l{n}"/><child link="l{n + 1}"/>'
        f'<origin xyz="0 0 0.1" rpy="0 0 0"/><axis xyz="0 {n % 2} {1 - n % 2}"/>'
        '<limit lower="-3" upper="3" velocity="2" effort="50"/></joint>'
        for n in range(6)
    )
    return [f'<?xml version="1.0"?><robot name="arm">{links}{joints}</robot>'.encode()]


def start() -> Callable[[bytes], None]:
    """See Target."""
    path = scratch("arm.urdf")

    def take(data: bytes) -> None:
        path.write_bytes(data)
        try:
            chain = read_urdf(path, "l6")
        except InputError as error:
            one_line(error)
            return
        check(6 <= len(chain.joint_names) <= 7, "an arm of another number of joints")

    return take


TARGET = Target(
    edge="URDF", promise="a refusal is one line", seeds=seeds, start=start, shape="text", longest=8192
)
