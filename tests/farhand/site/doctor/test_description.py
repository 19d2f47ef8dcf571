"""What the doctor says of the robot itself: one or two, and the one of the scenario or another."""

from farhand.common.messages.scene import Scene
from farhand.runs.scenario import load_scenario, replace_settings
from farhand.site.doctor.description import Listening, judge_robot
from farhand.testing import description, scene, state

SCENARIO = replace_settings(load_scenario("point-obstacle"), {"robot.radius": 0.1})
MS = 1_000_000


class Deaf:
    def declare_subscriber(self, key, hear):
        return None


def listened(*messages):
    heard = Listening(Deaf(), "r")
    for at_ms, message in messages:
        heard.take(message, at_ms * MS)
    return heard


def same_scene(**changes):
    given = {"obstacles": SCENARIO.obstacles, "targets": SCENARIO.targets} | changes
    return Scene(source="r", session=9, seq=0, t_sent_ns=0, t_sample_ns=0, **given)


def test_the_scenarios_own_robot():
    found = judge_robot(listened((0, description()), (0, same_scene())), SCENARIO)
    assert [(f.level, f.what) for f in found] == [("good", "scenario")]


def test_another_robot_another_scene():
    found = judge_robot(listened((0, description(lag=0.4)), (0, same_scene(obstacles=()))), SCENARIO)
    assert [f.level for f in found] == ["note", "note"]
    assert "robot.lag 0.4 s (here 0.1)" in found[0].found
    assert f"obstacle {SCENARIO.obstacles[0].id!r} is only here" in found[1].found
    assert all("--scenario" in f.remedy for f in found)


def test_two_robots_of_one_name_are_bad():
    states = [(t, state(t, session=1 + k)) for t in range(0, 1500, 10) for k in (0, 1)]
    heard = listened(*states)
    assert heard.states == 300
    (found,) = judge_robot(heard, SCENARIO)
    assert (found.level, found.what) == ("bad", "one robot")


def test_nothing_is_said_of_what_did_not_come():
    assert judge_robot(listened((0, state())), SCENARIO) == []
    assert [f.level for f in judge_robot(listened((0, scene())), SCENARIO)] == ["note"]
