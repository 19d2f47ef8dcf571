"""What the guard did is said with part, obstacle, distance, limit and both speeds; and so is that it did nothing."""

import msgspec

from farhand.common.messages.intervention import Intervention
from farhand.robot_side.result import GuardedPair, RobotCounts
from farhand.runs.words.guard import guard_summary, guard_words

SLOWED = Intervention(
    part="forearm", obstacle="post-2", distance=0.031, limit=0.01, asked=0.3, done=0.12, what="slowed"
)


def test_an_intervention_names_part_obstacle_distance_limit_and_speeds():
    assert guard_words(SLOWED) == (
        "slowed: forearm 31 mm from post-2, limit 10 mm; 0.30 m/s asked, 0.12 m/s done"
    )


def test_two_speeds_that_differ_never_read_alike():
    little = msgspec.structs.replace(SLOWED, done=0.298)
    assert guard_words(little).endswith("0.300 m/s asked, 0.298 m/s done")


def counts(**fields):
    return RobotCounts(**{"min_clearance": 0.05, "ticks": 500, "stops": 0, "guarded": True} | fields)


def test_a_run_counts_and_times_it():
    pairs = [GuardedPair(part="forearm", obstacle="post-2", seconds=2.0, distance=0.031)]
    did = counts(guard_times=3, guard_seconds=2.5, guard_deeds={"turned": 0.5, "slowed": 2.0})
    assert guard_summary(did, pairs) == (
        "acted 3 times, for 2.5 s (slowed 2.0 s, turned 0.5 s): forearm and 'post-2' 2.0 s, 31 mm least, "
        "as the guard measures"
    )
    many = [GuardedPair(part="forearm", obstacle=f"o{k}", seconds=1.0, distance=0.02) for k in range(7)]
    assert guard_summary(did, many).endswith("'o3' 1.0 s, 20 mm least; and 3 more, as the guard measures")


def test_a_guard_that_is_off_or_idle_or_unknown_is_said_to_be():
    assert guard_summary(counts(guarded=False), []) == "off"
    assert guard_summary(counts(), []) == "on; had nothing to do"
    assert guard_summary(counts(ticks=0), []) == ""
