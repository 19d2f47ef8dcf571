"""What each reason means for which the robot refuses a command; docs/recordings.md has the same words."""

MEANINGS = {
    "stale": "built on a state of the robot that is older than safety.max_age, as after a silence of the network",
    "foreign-session": (
        "of a session that is not in control; so are an operator's own, for a round trip, after control became free "
        "by a silence or an emergency stop, or was handed over"
    ),
    "held": (
        "a request for control, or an acknowledgement, of a session that is not in control; so are an operator's own, "
        "as with foreign-session"
    ),
    "old-seq": "not newer than the last of its session: a later one overtook it, or it came a second time",
    "late-release": "gives up control that it does not have, or not any more",
    "no-successor": "hands control over to a session that does not wait for it",
    "no-echo": "built on no state of the robot",
    "foreign-echo": "built on a state of another start of the robot",
    "stopped": "to move while the robot was stopped and not acknowledged",
    "unseen-stop": "acknowledges a stop that its sender had not seen yet",
    "too-fast": "faster than safety.max_speed",
    "turns-too-fast": "turns faster than safety.max_angular_speed",
    "flood": "more at once than are looked at",
    "length": "longer than a message may be",
    "malformed": "no message",
    "checksum": "damaged on the way: its check does not fit",
    "schema": "of another version of the messages",
    "unknown-field": "a message with a field that is not known",
    "non-finite": "with a number that is none, or infinite",
    "type": "a message with a field of the wrong type or size",
}


def meaning(reason: str) -> str:
    """In words; a reason that is not known here is its own word."""
    return MEANINGS.get(reason, reason)
