"""Whether the machine kept up with a run in real time: the network it had was else not the one that was asked for."""

from farhand.runs.results import Counts

NETEM_LATE, ROBOT_LATE = 0.010, 0.020
"""Of messages at the emulator and of the robot's loop (s), at the 99th of a hundred: more is said."""
TICK_LATE = 0.5
"""Likewise of the operator's ticks, as a share of their period."""


def slowness(counts: Counts, network: str, period: float) -> str:
    """A line where loops or messages were far off what was asked; empty where all kept up.

    Args:
        counts: of the programs.
        network: that was asked for.
        period: of an operator's tick (s).
    """
    netem, operator, robot = counts.netem, counts.operator, counts.robot
    found = []
    if netem is not None:
        late = max(netem.uplink.error.p99, netem.downlink.error.p99)
        if late > NETEM_LATE:
            found.append(f"the emulator's messages left {late * 1e3:.0f} ms late")
    if operator is not None and operator.lateness_p99 is not None:
        late = operator.lateness_p99
        if late > TICK_LATE * period:
            found.append(f"the operator's ticks began {late * 1e3:.0f} ms late")
    if robot is not None and robot.lateness is not None and robot.lateness.p99 > ROBOT_LATE:
        found.append(f"the robot's loop was {robot.lateness.p99 * 1e3:.0f} ms late")
    if not found:
        return ""
    return f"this machine was too slow for {network} as it was asked for: {', '.join(found)} (at p99)"
