"""What a network is like, in words."""

from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.netem.impairments.registry import IMPAIRMENTS
from farhand.netem.models.profiles import PROFILES
from farhand.netem.spec import parse_spec
from farhand.trials.fuzz.target import Target, check


def seeds() -> list[bytes]:
    """Every word's own example, some profiles, and tc's words."""
    words = [IMPAIRMENTS.get(name).example for name in IMPAIRMENTS.names()]
    examples = [each for word in words for each in word.split(" or ") if each]
    several = [
        "gaussian:50,20 loss:gilbert(2%,20%) command[none] state[loss:5%]",
        "delay 50ms 20ms distribution normal loss 1% corrupt 0.1% reorder 5% 50%",
        "none",
        *list(PROFILES)[:3],
    ]
    return [text.encode() for text in (*examples, *several)]


def start() -> Callable[[bytes], None]:
    """See Target."""

    def take(data: bytes) -> None:
        try:
            spec = parse_spec(data.decode("utf-8", "replace"))
        except InputError as error:
            check(bool(str(error).strip()), "a refusal without a word")
            return
        check(parse_spec(str(spec)) == spec, f"{str(spec)!r} is not read back as it was")

    return take


TARGET = Target(
    edge="network SPECs, and tc's words",
    promise="what is read is written and read back the same",
    seeds=seeds,
    start=start,
    shape="text",
    longest=512,
)
