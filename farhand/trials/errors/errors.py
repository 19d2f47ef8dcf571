"""What is injected, error by error: by the network, and by a hostile client."""

from collections.abc import Callable
from dataclasses import dataclass

from farhand.common.link.link import Packet
from farhand.trials.errors.strikes import (
    Strike,
    empty_scenes,
    flip_commands,
    flip_states,
    foreign_states,
    forged_states,
    garbage,
    holding_back,
    insert,
    masquerade,
    other_key,
    others_command,
    own_operators_for_other,
    repeat_commands,
    repeat_states,
    schema,
    shuffling,
    stale_echo,
)
from farhand.trials.errors.world import World


@dataclass(frozen=True, slots=True)
class Injected:
    """One row of the table.

    Attributes:
        error: one of the eight of IEC 61784-3.
        how: what is injected, in words.
        up, down: the network's SPEC meanwhile; empty: as before.
        strike: what a hostile client does a hundred times a second; None: there is none.
        holds: whether it takes the place of the packets for the robot, see `World.before_robot`.
        insider: whether it needs what TLS and rights keep from strangers: a lawful session to be forged.
        guarded: whether the robot's guard is on and something in the way, so that what counts is what it touches.
    """

    error: str
    how: str
    up: str = ""
    down: str = ""
    strike: Strike | None = None
    holds: Callable[[World], Callable[[Packet, int], None]] | None = None
    insider: bool = False
    guarded: bool = False


CORRUPTION, REPETITION, SEQUENCE, LOSS = "corruption", "unintended repetition", "incorrect sequence", "loss"
DELAY, INSERTION, MASQUERADE, ADDRESSING = "unacceptable delay", "insertion", "masquerade", "addressing"
ERRORS: dict[str, Injected] = {
    "corrupt-up": Injected(CORRUPTION, "a bit of every command flipped (netem)", up="corrupt:100%"),
    "corrupt-down": Injected(
        CORRUPTION, "a bit of every state, scene and description flipped (netem)", down="corrupt:100%"
    ),
    "corrupt-some": Injected(
        CORRUPTION, "a bit of every third message flipped, both ways (netem)", "corrupt:33%", "corrupt:33%"
    ),
    "flipped-commands": Injected(CORRUPTION, "commands again with 1 to 8 bits flipped", strike=flip_commands),
    "flipped-states": Injected(CORRUPTION, "states again with 1 to 8 bits flipped", strike=flip_states),
    "garbage": Injected(CORRUPTION, "random bytes at both ends", strike=garbage),
    "schema": Injected(CORRUPTION, "commands of another schema version", strike=schema),
    "duplicate": Injected(
        REPETITION, "every message twice, both ways (netem)", "duplicate:100%", "duplicate:100%"
    ),
    "old-commands": Injected(REPETITION, "any earlier command of the session again", strike=repeat_commands),
    "old-states": Injected(
        REPETITION, "any earlier state, scene and description again", strike=repeat_states
    ),
    "reorder": Injected(
        SEQUENCE, "each 0 to 400 ms under way, in any order (netem)", "uniform:0,400", "uniform:0,400"
    ),
    "shuffled": Injected(SEQUENCE, "commands in fours, each four in any order", holds=shuffling),
    "loss-up": Injected(LOSS, "no command arrives (netem)", up="loss:100%"),
    "loss-down": Injected(LOSS, "no state arrives (netem)", down="loss:100%"),
    "loss-bursts": Injected(
        LOSS, "half of all is lost, in bursts (netem)", "loss:gilbert(10%,10%)", "loss:gilbert(10%,10%)"
    ),
    "delay-up": Injected(DELAY, "commands 2 s late (netem)", up="constant:2000"),
    "delay-down": Injected(DELAY, "states 2 s late (netem)", down="constant:2000"),
    "held-up": Injected(DELAY, "commands kept back for 1.2 s each", holds=holding_back),
    "burst": Injected(
        DELAY,
        "all kept for 2 s, then at once (netem)",
        "outage:every(2.1s,2s,hold)",
        "outage:every(2.1s,2s,hold)",
    ),
    "foreign": Injected(INSERTION, "fast commands of another session, on the newest state", strike=insert()),
    "foreign-blind": Injected(INSERTION, "the same without an echo", strike=insert(echo=None)),
    "foreign-release": Injected(INSERTION, "`release` of another session", strike=insert(mode="release")),
    "foreign-acknowledge": Injected(
        INSERTION, "`acknowledge` of another session: asks for control", strike=insert(mode="acknowledge")
    ),
    "foreign-estop": Injected(
        INSERTION, "`estop` of another session: obeyed on purpose", strike=insert(mode="estop")
    ),
    "same-session-old": Injected(MASQUERADE, "the lawful session, an old number", strike=masquerade(-3)),
    "same-session-blind": Injected(
        MASQUERADE, "the lawful session, a new number, no echo", strike=masquerade(1, echo=None)
    ),
    "same-session-stale": Injected(
        MASQUERADE, "the lawful session, a new number, an old echo", strike=stale_echo
    ),
    "same-session-fast": Injected(
        MASQUERADE,
        "all forged rightly, but too fast",
        strike=masquerade(1, velocity=(2.5, 0.0, 0.0)),
        insider=True,
    ),
    "other-robots-states": Injected(
        MASQUERADE, "states of another session under this robot's key", strike=foreign_states
    ),
    "forged": Injected(
        MASQUERADE, "session, number and echo all forged rightly", strike=masquerade(1), insider=True
    ),
    "forged-guarded": Injected(
        MASQUERADE,
        "the same, guard on, obstacles in the way",
        strike=masquerade(1),
        insider=True,
        guarded=True,
    ),
    "forged-states": Injected(
        MASQUERADE,
        "the robot's own session forged: a metre beside the truth; guard on",
        strike=forged_states,
        insider=True,
        guarded=True,
    ),
    "empty-scenes": Injected(
        MASQUERADE,
        "the robot's own session forged: scenes without obstacles; guard on",
        strike=empty_scenes,
        insider=True,
        guarded=True,
    ),
    "other-key": Injected(ADDRESSING, "commands and states under another robot's key", strike=other_key),
    "others-command": Injected(
        ADDRESSING, "another robot's commands under this one's key", strike=others_command
    ),
    "own-for-other": Injected(
        ADDRESSING,
        "its own operator's commands for another robot, under this one's key",
        strike=own_operators_for_other,
    ),
}
