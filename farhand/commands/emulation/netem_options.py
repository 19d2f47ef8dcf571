"""What options of `farhand netem` mean."""

from collections.abc import Iterable

from farhand.common.errors import InputError
from farhand.common.messages.keys import check_robot_name
from farhand.netem.netem_node import DIRECTIONS
from farhand.netem.spec import parse_spec


def own_networks(texts: Iterable[str]) -> tuple[tuple[str, str, str], ...]:
    """(robot, direction or "both", SPEC) of each NAME=SPEC, NAME:uplink=SPEC or NAME:downlink=SPEC.

    Raises:
        InputError: one has another form, or is there twice.
    """
    found: dict[tuple[str, str], str] = {}
    for text in texts:
        where, separator, spec = text.partition("=")
        robot, colon, direction = where.partition(":")
        if not separator or (colon and direction not in DIRECTIONS):
            raise InputError(
                f"--robot-network {text!r}: expected NAME=SPEC, NAME:uplink=SPEC or NAME:downlink=SPEC, "
                "such as arm2=constant:100"
            )
        check_robot_name(robot)
        parse_spec(spec).prepare()
        place = robot, direction or "both"
        if place in found:
            raise InputError(f"--robot-network {text!r}: {where!r} is there twice; leave one out")
        found[place] = spec
    return tuple((robot, direction, spec) for (robot, direction), spec in found.items())
