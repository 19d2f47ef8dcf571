"""Why nothing is asked of a robot, in words for people."""

from farhand.operator_side.supervision import NOT_ENGAGED


def standing_words(reason: str, *, done: bool) -> str:
    """A reason of the operator's side for which it commands zero, with what it means where that is not plain.

    Args:
        reason: as the operator's side reports it.
        done: whether all targets are reached.
    """
    if reason != NOT_ENGAGED:
        return reason
    return f"{reason}: {'all targets are reached' if done else 'nothing is asked of the robot'}"
