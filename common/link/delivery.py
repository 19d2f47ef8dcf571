"""How each class of message travels: one row a class, found by the kind in its key.

- `every`: each counts. The robot counts and refuses commands one by one, and the operator estimates loss and
  round trips from the numbers of the states.
- `newest`: only the newest of its key counts, so that one that waits gives way to it.

Congestion. A link that is congested either holds the publishing thread (`block`: at most 0.2 s, then Zenoh gives
the link up) or has the message dropped. Zenoh drops now and then on links that nothing disturbs, nine or ten
of a stream at once, so that whatever is missed when it is lost blocks. A picture is not missed, and a large one
must not hold what comes after it: it may be dropped.

Priority. On the wire a message of a higher priority overtakes what waits. On an idle link all take the same
time; on a slow one a picture of 30 kB is 300 commands. Within a class the order is kept.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from farhand.common.messages.keys import kind_of

Keep = Literal["every", "newest"]
OTHER = "other"


@dataclass(frozen=True, slots=True)
class Delivery:
    """Attributes:
    keep: see the module's docstring.
    priority: name of one of Zenoh's priorities.
    blocks: whether congestion holds the publishing thread; else the message is dropped.
    """

    keep: Keep
    priority: str
    blocks: bool


CLASSES: Mapping[str, Delivery] = {
    "command": Delivery("every", "REAL_TIME", True),  # what moves and what stops the robot: before all
    "state": Delivery("every", "REAL_TIME", True),  # the other half of the loop
    "scene": Delivery(
        "newest", "INTERACTIVE_HIGH", True
    ),  # once a second: one that is lost is missed for long
    "scene_request": Delivery("every", "DATA_HIGH", True),  # seldom; each is answered
    "description": Delivery("newest", "DATA_HIGH", True),  # seldom, and needed before anything moves
    "report": Delivery("newest", "DATA", True),  # on a session of its own, where nothing waits behind it
    "mirror": Delivery("newest", "DATA", True),  # on the reports' session
    "steering": Delivery("every", "REAL_TIME", True),  # a stop in it must not give way to what comes after
    "camera": Delivery("newest", "BACKGROUND", False),  # large, and old at once
    OTHER: Delivery("every", "DATA", True),
}


def class_of(key: str) -> str:
    """The class of a key, the name of its row; a mirrored picture is a picture still."""
    kind = kind_of(key)
    if kind == "mirror" and key.endswith("/camera"):
        return "camera"
    return kind if kind in CLASSES else OTHER
