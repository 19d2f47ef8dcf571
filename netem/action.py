"""A change of the network while it runs: the same for live control and for timelines."""

import math
from typing import Literal

import msgspec

from farhand.common.errors import InputError
from farhand.common.messages.keys import check_robot_name
from farhand.common.timing.clock import to_ns
from farhand.netem.impairments.registry import kinds
from farhand.netem.netem_node import DIRECTIONS, NetemNode
from farhand.netem.spec import CLASSES, Spec, parse_spec

Do = Literal["set", "add", "remove", "outage", "reset", "common"]
MAX_OUTAGE = 1e6


class Action(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One change.

    Attributes:
        do: set (the whole SPEC), add (words, in place of those of the same kind), remove (a kind of
            word, or a class), outage (from now on), reset (to the SPECs of the start), common (the
            robot shares the common network again).
        direction: "uplink", "downlink" or "both"; remove takes from both what is there.
        spec: for set and add.
        name: for remove: a kind of word, such as loss, or a class of messages.
        length: of the outage (s).
        hold: whether the outage keeps messages until its end, instead of dropping them.
        robot: whose own network is meant; one that has none gets a copy of the common one, and with
            it streams and queues of its own. Empty: the common network; an outage and a reset without
            a robot are for all.
    """

    do: Do
    direction: Literal["both", "uplink", "downlink"] = "both"
    spec: str = ""
    name: str = ""
    length: float = 0.0
    hold: bool = False
    robot: str = ""

    def check(self) -> None:
        """Raise InputError unless the action makes sense by itself; opens the files that it names."""
        if self.robot:
            check_robot_name(self.robot)
        elif self.do == "common":
            raise InputError("common: say which robot goes back to the common network")
        if self.do in ("set", "add"):
            parse_spec(self.spec).prepare()
        elif self.spec:
            raise InputError(f"{self.do}: takes no spec")
        if self.do == "remove" and self.name not in (known := (*kinds(), *CLASSES)):
            raise InputError(f"remove: no such thing as {self.name!r}; one of {', '.join(known)}")
        if self.do == "outage" and not (math.isfinite(self.length) and 0 < self.length <= MAX_OUTAGE):
            raise InputError(
                f"outage: the length is {self.length} s; it must be above 0, at most {MAX_OUTAGE:g}"
            )

    def perform(self, node: NetemNode, now_ns: int) -> None:
        """Change the network; raises InputError and then has changed nothing."""
        self.check()
        names = DIRECTIONS if self.direction == "both" else (self.direction,)
        directions = [node.directions[name] for name in names]
        robot_only = bool(self.robot) and self.do in ("reset", "common")
        if robot_only and not any(direction.has_own(self.robot) for direction in directions):
            raise InputError(f"{self.do}: robot {self.robot!r} has no network of its own there")
        if self.do == "reset":
            for direction in directions:
                direction.reset(self.robot)
        elif self.do == "common":
            for direction in directions:
                direction.share(self.robot)
        elif self.do == "outage":
            for direction in directions:
                direction.outage(now_ns, to_ns(self.length), self.hold, self.robot)
        else:
            if self.do == "remove" and self.direction == "both":
                # What is there is taken: a word of one direction needs no naming of it.
                there = [
                    each for each in directions if each.spec_for(self.robot).without(self.name) is not None
                ]
                directions = there or directions
            specs = [self._changed(each.spec_for(self.robot), each.name) for each in directions]
            for direction, spec in zip(directions, specs, strict=True):
                direction.set_spec(spec, self.robot)
        node.changes += 1

    def _changed(self, spec: Spec, direction: str) -> Spec:
        if self.do == "set":
            return parse_spec(self.spec)
        if self.do == "add":
            return spec.with_words(parse_spec(self.spec))
        found = spec.without(self.name)
        if found is None:
            whose = f" of robot {self.robot!r}" if self.robot else ""
            raise InputError(f"remove: the {direction}{whose} has no {self.name!r}; it is {spec}")
        return found
