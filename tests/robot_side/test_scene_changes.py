"""Changes of a running robot's scene, in virtual time: obeyed once, announced, and never on the robot."""

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.messages import scene_request
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import scene_request_key
from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.scene_request import SceneRequest
from farhand.common.seeds import stream
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.sphere import Sphere
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import load_scenario, replace_setting
from farhand.testing import ScriptedLink, command, echo_of

SESSION = 1234
SECOND = 1_000_000_000
SCENARIO = load_scenario("point-obstacle")
POST = Obstacle("post", (2.0, 2.0, 0.6), 0.1)
FAR = Obstacle("far", (4.0, 2.0, 0.6), 0.1)


class Bench:
    """A robot's node, and whoever asks it for something."""

    def __init__(self, scenario=SCENARIO, session=SESSION):
        self.link = ScriptedLink("r1")
        self.node = RobotNode(scenario, make_robot(scenario), self.link, "r1", session)
        self.now = 7 * SECOND
        self.states, self.scenes = [], []
        self.asked = 0
        self.tick(2)

    def tick(self, n=1):
        for _ in range(n):
            self.link.now_ns = self.now
            self.now = self.node.step(self.now)
            self.states += self.link.take("state")
            self.scenes += self.link.take("scene")

    @property
    def ids(self):
        return [o.id for o in self.scenes[-1].obstacles]

    def request(self, deed="add", *obstacles, gone=(), **fields):
        """The next request, by a session of its own, built on the newest state."""
        self.asked += 1
        defaults = {"source": "anna", "session": 100 + self.asked, "seq": 0, "t_sent_ns": 5}
        defaults |= {"echo": echo_of(self.states[-1]), "base": self.scenes[-1].changes}
        return SceneRequest(deed=deed, obstacles=obstacles, gone=gone, **(defaults | fields))

    def ask(self, *args, **fields):
        """Ask, and the answer in the scene that is announced."""
        request = self.request(*args, **fields)
        self.link.feed(request, self.now)
        self.tick(7)  # an answer waits for 0.1 s at the most
        return self.answer_to(request)

    def answer_to_last(self):
        return next(a for a in self.scenes[-1].answers if a.session == 100 + self.asked)

    def answer_to(self, request):
        return next((a for a in self.scenes[-1].answers or () if a.session == request.session), None)


def test_a_scene_that_nobody_changes_says_nothing_of_changes():
    bench = Bench()
    bench.tick(200)
    assert all(s.revision is msgspec.UNSET and s.answers is msgspec.UNSET for s in bench.scenes)
    assert bench.node.summary().scene_changes == 0


def test_add_remove_and_set_are_obeyed_at_once_and_announced_with_a_revision():
    bench = Bench()
    had = bench.ids
    assert bench.ask("add", POST, FAR).refusal == ""
    assert (bench.ids, bench.scenes[-1].revision) == ([*had, "post", "far"], 1)
    assert bench.ask("remove", gone=("post",)).refusal == ""
    assert (bench.ids, bench.scenes[-1].revision) == ([*had, "far"], 2)
    assert bench.ask("set", POST).refusal == ""
    assert (bench.ids, bench.scenes[-1].revision) == (["post"], 3)
    assert bench.ask("set").refusal == ""
    assert (bench.ids, bench.scenes[-1].revision) == ([], 4)
    bench.tick(60)  # announced again and again for a second: a network may lose some
    assert sum(s.revision == 4 for s in bench.scenes) >= 8
    assert bench.node.summary().scene_changes == 4
    said = list(bench.node.scene_intake.log)
    assert said[0].startswith("scene: revision 1 by anna: came post, far; ")
    assert said[1].startswith("scene: revision 2 by anna: went post; ")


def test_the_clearance_is_that_of_the_new_scene_from_the_next_tick_on():
    bench = Bench()
    x, y, z = SCENARIO.start
    near = Obstacle("near", (x, y, z + SCENARIO.robot.radius + 0.35), 0.1)
    before = bench.states[-1].clearance
    bench.ask("add", near)
    assert bench.states[-1].clearance == pytest.approx(0.25, abs=1e-9)
    bench.ask("remove", gone=("near",))
    assert bench.states[-1].clearance == pytest.approx(before)
    assert (
        bench.node.summary().nearest_obstacle == "near"
    )  # by what it was at the nearest, not by what is there now


def test_what_moves_goes_on_while_others_come_and_go():
    mover = Obstacle("mover", (3.0, 3.0, 0.6), 0.1, (-0.1, 0.0, 0.0))
    bench = Bench(msgspec.structs.replace(SCENARIO, obstacles=(mover,)))
    start = bench.scenes[0]
    bench.tick(50)
    bench.ask("add", POST)
    bench.tick(50)
    bench.ask("remove", gone=("post",))
    bench.tick(60)
    last = bench.scenes[-1]
    gone = (last.t_sample_ns - start.t_sample_ns) * 1e-9
    assert last.obstacles[0].position[0] == pytest.approx(3.0 - 0.1 * gone, abs=1e-9)


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (("add", POST, POST), "'post' is named twice"),
        (("add", Obstacle("obstacle", (9.0, 9.0, 9.0), 0.1)), "'obstacle' is there already; remove it first"),
        (("set", *(Obstacle(f"o{k}", (9.0, k, 0.0), 0.1) for k in range(2)), POST, POST), "named twice"),
        (("remove",), "there is no obstacle ''"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(ask, said):
    bench = Bench(msgspec.structs.replace(SCENARIO, obstacles=(Obstacle("obstacle", (9.0, 0.0, 0.0), 0.1),)))
    answer = bench.ask(*ask)
    assert said in answer.refusal
    assert answer.settled
    assert bench.ids == ["obstacle"]
    assert bench.scenes[-1].revision is msgspec.UNSET


def test_too_many_are_refused_and_an_unknown_one_is_named():
    bench = Bench()
    many = [Obstacle(f"o{k}", (9.0, 0.1 * k, 0.0), 0.01) for k in range(1024)]
    assert bench.ask("add", *many[:600]).refusal == ""
    assert "1026 obstacles, at most 1024" in bench.ask("add", *many[600:]).refusal
    assert "no obstacle 'gone'; there are " in bench.ask("remove", gone=("gone",)).refusal


@pytest.mark.parametrize("guard", [True, False])
def test_an_obstacle_on_the_robot_is_refused_with_part_and_obstacle(guard):
    bench = Bench(replace_setting(SCENARIO, "guard.on", guard))
    x, y, z = SCENARIO.start
    reach = SCENARIO.robot.radius + 0.1
    answer = bench.ask("add", Obstacle("bump", (x, y, z + reach - 0.02), 0.1))
    assert "tool" in answer.refusal
    assert "20 mm inside obstacle 'bump'" in answer.refusal
    near = bench.ask("add", Obstacle("near", (x, y, z + reach + 0.005), 0.1))
    assert bool(near.refusal) == guard
    if guard:
        assert "5 mm from obstacle 'near'; 10 mm are kept" in near.refusal


def test_an_obstacle_that_the_robot_could_not_stop_before_is_refused_until_it_stands():
    bench = Bench()
    for k in range(30):
        bench.link.feed(command(k, velocity=(0.5, 0.0, 0.0), echo=echo_of(bench.states[-1])), bench.now)
        bench.tick()
    x, y, z = bench.states[-1].position
    ahead = Obstacle("ahead", (x + SCENARIO.robot.radius + 0.1 + 0.03, y, z), 0.1)
    assert "moves too fast to stop before it" in bench.ask("add", ahead).refusal
    bench.link.feed(command(99, "hold", echo=echo_of(bench.states[-1])), bench.now)
    bench.tick(100)
    x, y, z = bench.states[-1].position
    ahead = Obstacle("ahead", (x + SCENARIO.robot.radius + 0.1 + 0.03, y, z), 0.1)
    assert bench.ask("add", ahead).refusal == ""


def test_a_request_that_is_sent_again_is_obeyed_once_and_answered_again():
    bench = Bench()
    first = bench.request("add", POST)
    bench.link.feed(first, bench.now)
    bench.tick(2)
    for seq in (1, 2):
        again = msgspec.structs.replace(first, seq=seq, echo=echo_of(bench.states[-1]))
        bench.link.feed(again, bench.now)
        bench.tick(6)
    assert bench.answer_to(first).refusal == ""
    assert (bench.ids.count("post"), bench.scenes[-1].revision) == (1, 1)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"echo": None}, "no-echo"),
        ({"echo": "foreign"}, "foreign-echo"),
        ({"echo": "old"}, "stale"),
        ({"base": 7}, "changed"),
    ],
)
def test_what_is_not_built_on_what_is_there_now_changes_nothing(change, reason):
    bench = Bench()
    echo = echo_of(bench.states[-1])
    bench.tick(80)
    echoes = {"foreign": msgspec.structs.replace(echo, session=9), "old": echo}
    fields = {k: echoes.get(v, v) if isinstance(v, str) else v for k, v in change.items()}
    assert bench.ask("add", POST, **fields).refusal
    assert "post" not in bench.ids
    assert bench.node.summary().scene_refused == {reason: 1}


def test_requests_to_an_earlier_start_of_the_robot_change_nothing():
    old = Bench(session=1)
    request = old.request("set")
    bench = Bench(session=2)
    bench.link.feed(request, bench.now)
    bench.tick(2)
    assert len(bench.ids) == len(SCENARIO.obstacles)
    assert bench.node.summary().scene_refused == {"foreign-echo": 1}


@pytest.mark.parametrize("payload", [b"", b"\x81\xa1a" * 100, b"x" * (1 << 21)])
def test_garbage_changes_nothing_and_stops_nothing(payload):
    bench = Bench()
    bench.link.feed(payload, bench.now, "farhand/r1/scene_request")
    bench.tick(3)
    assert bench.node.watchdog.stops == 0
    assert sum(bench.node.summary().scene_refused.values()) == 1


def test_a_flood_neither_stops_the_robot_nor_floods_its_operator():
    bench = Bench()
    first = bench.request("set")
    before = len(bench.scenes)
    for _ in range(50):
        for _ in range(40):
            bench.link.feed(first, bench.now)
        bench.tick()
    assert bench.node.watchdog.stops == 0
    assert len(bench.scenes) - before <= 15  # a second's worth, ten a second at the most


NAMES = ("a", "b", "c")
DEEDS = st.lists(
    st.tuples(st.sampled_from(["add", "remove", "set"]), st.sampled_from(NAMES)), min_size=1, max_size=8
)
ARRIVALS = st.lists(st.tuples(st.integers(0, 7), st.integers(0, 40)), max_size=24)


@settings(max_examples=60, deadline=None)
@given(DEEDS, ARRIVALS)
def test_whatever_is_replayed_or_late_the_scene_is_what_was_obeyed_last(deeds, replays):
    """Requests are made one after the other, each once its answer is there; copies of all come at any later time."""
    bench = Bench(msgspec.structs.replace(SCENARIO, obstacles=()))
    sent, truth = [], []
    copies = [(which, ticks) for which, ticks in replays]
    for deed, name in deeds:
        one = Obstacle(name, (5.0, float(NAMES.index(name)), 0.0), 0.1)
        request = bench.request(
            deed, *(() if deed == "remove" else (one,)), gone=(name,) if deed == "remove" else ()
        )
        bench.link.feed(request, bench.now)
        sent.append(request)
        bench.tick(7)
        if bench.answer_to(request).refusal == "":
            truth = {"add": [*truth, name], "set": [name], "remove": [n for n in truth if n != name]}[deed]
        for which, ticks in copies[:3]:
            bench.link.feed(sent[which % len(sent)], bench.now)
            bench.tick(1 + ticks)
        copies = copies[3:]
        bench.tick(6)
        assert bench.ids == truth
        assert sum(bench.node.scene_intake.revision == s.changes for s in bench.scenes[-1:]) == 1


NEAR = st.floats(-0.6, 0.6, allow_nan=False)


@settings(max_examples=40, deadline=None)
@given(
    st.tuples(*[st.floats(-0.5, 0.5, allow_nan=False)] * 3),
    st.lists(st.tuples(NEAR, NEAR, NEAR, st.integers(0, 15)), min_size=1, max_size=8),
)
def test_no_obstacle_that_is_let_in_is_ever_nearer_than_the_guard_keeps(velocity, comers):
    """Commanded on as before, whatever comes: what was let in is kept off."""
    bench = Bench(msgspec.structs.replace(SCENARIO, obstacles=()))
    seq = 0
    for number, (x, y, z, ticks) in enumerate(comers):
        for _ in range(ticks + 4):
            seq += 1
            bench.link.feed(command(seq, velocity=velocity, echo=echo_of(bench.states[-1])), bench.now)
            bench.tick()
        at = tuple(a + b for a, b in zip(bench.states[-1].position, (x, y, z), strict=True))
        bench.link.feed(bench.request("add", Obstacle(f"o{number}", at, 0.1)), bench.now)
    for _ in range(100):
        seq += 1
        bench.link.feed(command(seq, velocity=velocity, echo=echo_of(bench.states[-1])), bench.now)
        bench.tick()
    nearest = bench.node.summary().min_clearance
    assert nearest is None or nearest >= SCENARIO.guard.d_min


def test_an_arm_keeps_off_whatever_is_let_in_beside_it_while_it_moves():
    """Spheres, boxes and capsules all around a UR5 that is driven to and fro; the nearest are refused by name."""
    scenario = msgspec.structs.replace(load_scenario("ur5-obstacle"), obstacles=())
    bench, rng = Bench(scenario), stream(3, "comers")
    period, let_in, refused, seq = round(scenario.robot.rate_hz * 0.02), 0, [], 0
    for number in range(60):
        way = rng.uniform(-0.25, 0.25, 3)
        for _ in range(10):
            seq += 1
            drive = command(seq, velocity=tuple(way.tolist()), echo=echo_of(bench.states[-1]))
            bench.link.feed(drive, bench.now)
            bench.tick(period)
        at = np.array(bench.states[-1].position) * rng.uniform(0.0, 1.1) + rng.uniform(-0.25, 0.25, 3)
        shape = (Sphere(0.04), Box((0.03, 0.05, 0.04)), Capsule(0.02, 0.1))[number % 3]
        one = Obstacle(f"o{number}", tuple(at.tolist()), shape=shape)
        bench.ask("add", one)
        bench.tick(50)  # an answer waits for 0.1 s at the most
        answer = bench.answer_to_last()
        if answer.refusal:
            refused.append(answer.refusal)
        else:
            let_in += 1
            if let_in % 3 == 0:
                bench.ask("remove", gone=(one.id,))
    result = bench.node.summary()
    assert result.min_arm_clearance >= scenario.guard.d_min - 0.003  # which is 1 to 3 mm short of the truth
    assert result.stops == 0
    assert let_in > 10
    assert any(" mm inside obstacle 'o" in line and "link" in line for line in refused)
    assert any("moves too fast" in line for line in refused) or any(
        " mm from obstacle" in line for line in refused
    )


def test_what_the_loop_would_wait_for_is_refused():
    bench = Bench()
    movers = [
        Obstacle(f"m{i}", (3.0, 3.0, 0.6), 0.1, (-0.1, 0.0, 0.0))
        for i in range(scene_request.MOST_MOVERS + 1)
    ]
    assert bench.ask("add", *movers[1:]).refusal == ""
    assert "would move" in bench.ask("add", movers[0]).refusal
    boxes = [Obstacle(f"box-{i}", (5.0, 5.0, float(i)), 0.1) for i in range(1000)]
    bench.link.feed(bench.request("add", *boxes), bench.now)
    bench.tick(7)
    assert bench.node.scene_intake.refused["too-large"] == 1
    assert bench.ask("set").refusal == ""


@pytest.mark.parametrize("key", ["spheres", "cover", "centres"])
def test_nobody_can_say_by_what_an_obstacle_is_to_be_seen(key):
    """What travels are exact shapes: whoever solves for spheres makes them from these."""
    bench = Bench()
    asked = msgspec.msgpack.decode(encode(bench.request("add", POST)))
    asked["obstacles"][0][key] = [[0.0, 0.0, 0.0, 0.01]]
    bench.link.feed(msgspec.msgpack.encode(asked), bench.now, scene_request_key("r1"))
    bench.tick(7)
    assert bench.ids == [o.id for o in SCENARIO.obstacles]
    assert bench.node.scene_intake.refused == {"unknown-field": 1}


def test_a_copy_of_what_is_decided_is_told_again_however_many_have_asked_since():
    bench = Bench()
    first = bench.request("add", POST)
    bench.link.feed(first, bench.now)
    bench.tick(7)
    for _ in range(12):
        bench.ask("add", POST)
    assert bench.answer_to(first) is None
    bench.link.feed(first, bench.now)
    bench.tick(20)
    assert bench.answer_to(first).refusal == ""
    assert bench.ids.count("post") == 1


def test_a_mover_that_leaves_the_world_does_not_make_the_scene_unreadable():
    bench = Bench()
    rocket = Obstacle("rocket", (999_000.0, 3.0, 3.0), 0.1, (1000.0, 0.0, 0.0))
    assert bench.ask("add", rocket).refusal == ""
    bench.tick(300)
    assert Decoder(Scene).decode(encode(bench.scenes[-1])) is not None
    assert bench.ask("remove", gone=("rocket",)).refusal == ""
