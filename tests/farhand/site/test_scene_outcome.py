"""What is said of a change of the scene is what is known of it."""

from farhand.common.messages.scene import Obstacle, SceneAnswer
from farhand.common.shapes.sphere import Sphere
from farhand.site.scene import UNCONFIRMED, outcome
from farhand.site.scene_asking import Asker, Change, SceneAsking
from farhand.testing import scene, state

POST = Obstacle("post", (0.5, 0.0, 0.2), shape=Sphere(0.1))


def asked(*answers, seconds=6.0):
    """What is said after some answers of the robot's."""
    asking = SceneAsking(Asker("anna", 7), Change("add", (POST,)))
    asking.see(scene(0))
    assert asking.step(state(0, session=scene(0).session), 1) is not None
    for seq, answer in enumerate(answers):
        asking.see(scene(seq + 1, answers=(answer,)))
    return outcome(asking, "r", seconds)


def test_what_the_robot_decided_is_said():
    assert asked(SceneAnswer(7)) == ""
    assert asked(SceneAnswer(7, "it is in the way")) == "it is in the way"


def test_a_refusal_that_was_not_the_last_word_says_nothing_of_what_came_after():
    said = asked(SceneAnswer(7, "built on a state that is too old", settled=False), seconds=3.5)
    assert said.startswith(f"{UNCONFIRMED}: 'r' was asked and has not answered in 3.5 s")
    assert said.endswith("it had refused before: built on a state that is too old")
    assert asked(SceneAnswer(7, "too old", settled=False), SceneAnswer(7)) == ""
