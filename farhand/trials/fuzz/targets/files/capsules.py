"""Files of the capsules around an arm's links."""

from collections.abc import Callable
from pathlib import Path

import msgspec

from farhand.common.errors import InputError
from farhand.robot_side import arm
from farhand.robot_side.arm.capsules import MAX_CAPSULES, read_capsules
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, check, finite, one_line


def seeds() -> list[bytes]:
    """Those of the arms that are known by name."""
    return [path.read_bytes() for path in sorted((Path(arm.__file__).parent / "models").glob("*.toml"))]


def start() -> Callable[[bytes], None]:
    """See Target."""
    path = scratch("arm.toml")

    def take(data: bytes) -> None:
        path.write_bytes(data)
        try:
            file = read_capsules(path)
        except InputError as error:
            one_line(error)
            return
        check(1 <= len(file.capsules) <= MAX_CAPSULES, "too many capsules, or none")
        check(finite(msgspec.to_builtins(file)), "a number that is not finite")
        check(all(each.radius > 0.0 for each in file.capsules), "a capsule without a radius")

    return take


TARGET = Target(
    edge="capsules of an arm",
    promise="a refusal is one line; what is read is finite",
    seeds=seeds,
    start=start,
    shape="text",
    longest=8192,
)
