"""A scene that is changed while the robot is driven, in virtual time: kept clear of, recorded, replayed to the byte."""

from contextlib import ExitStack
from pathlib import Path
from typing import Any

import msgspec
import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.keys import scene_request_key
from farhand.common.messages.scene import Obstacle
from farhand.common.recording.reader import read_run
from farhand.laboratory.replay import replay
from farhand.laboratory.simulation import SimulationResult, _World
from farhand.report.page import Page
from farhand.report.reading.evidence import read_evidence
from farhand.report.reading.story import read_story
from farhand.runs.run import Run
from farhand.runs.scenario import load_scenario
from farhand.site.scene_asking import Asker, Change, SceneAsking

START, TARGET = (0.0, 0.0, 0.6), (6.0, 0.0, 0.6)
SCENARIO = msgspec.structs.replace(
    load_scenario("point-obstacle"),
    start=START,
    targets=(TARGET,),
    obstacles=(Obstacle("ball", (4.5, 1.5, 0.6), 0.1),),
)
POST = Obstacle("post", (3.0, 0.03, 0.6), 0.15)


def driven(
    path: Path, changes: dict[int, Change], network: str
) -> tuple[SimulationResult, list[SceneAsking], Any]:
    """A run in which changes are asked for at ticks, over the operator's own link, until each is answered."""
    run = msgspec.structs.replace(Run.over(SCENARIO, network, seed=5), time_limit=30.0)
    asked: list[SceneAsking] = []
    worlds: list[_World] = []

    def tick(report: Any) -> None:
        operator = worlds[0]._operator
        if report.tick in changes:
            asked.append(SceneAsking(Asker("anna", 50 + len(asked)), changes[report.tick]))
        for each in asked:
            each.see(operator.scene)
            payload = each.step(operator.state, report.t_sent_ns)
            if payload is not None:
                operator._link.send(Packet(scene_request_key(SCENARIO.robot.kind), payload))

    options: Any = {"record_to": path, "digest": True, "keep_reports": True, "listener": tick}
    with ExitStack() as closing:
        worlds.append(_World(run, options, closing))
        result = worlds[0].run()
    return result, asked, worlds[0]._robot


CHANGES = {
    20: Change("add", (POST,)),
    40: Change("remove", gone=("ball",)),
    75: Change("remove", gone=("post",)),
}


@pytest.fixture(scope="module", params=["none", "uniform:50,200 loss:10%"])
def run(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "run.mcap"
    return (path, request.param, *driven(path, CHANGES, request.param))


def test_each_change_is_answered_and_the_robot_goes_around_what_came(run):
    _, _, result, asked, robot = run
    assert [(a.done, a.refusal) for a in asked] == [(True, "")] * 3
    assert result.summary.finished
    summary = robot.summary()
    assert summary.scene_changes == 3
    assert summary.min_clearance >= SCENARIO.guard.d_min
    assert summary.nearest_obstacle == "post"


def test_the_operator_keeps_off_it_from_when_it_knows_until_it_is_told_that_it_is_gone(run):
    _, _, result, _, _ = run
    named = [k for k, r in enumerate(result.reports) if r.binding == "post"]
    assert named
    assert min(named) > 20
    end = next(k for k, r in enumerate(result.reports) if k > 75 and r.binding != "post")
    assert end - 75 < 15
    assert all(r.binding != "post" for r in result.reports[end:])


def test_it_is_replayed_to_the_byte_and_the_same_seed_gives_the_same_bytes(run, tmp_path):
    path, network, result, _, _ = run
    again, _, _ = driven(tmp_path / "again.mcap", CHANGES, network)
    assert again.digest == result.digest
    found = replay(path)
    assert found.identical
    assert len(found.ticks) == len(read_run(path).ticks)


def test_the_report_tells_each_change_and_what_is_drawn(run):
    path, _, _, _, _ = run
    story = read_story(path)
    told = [h.words for h in story.happenings if h.kind == "scene"]
    said = ["post came", "ball went", "post went"]
    assert told == [f"the scene was changed (revision {k}): {what}" for k, what in enumerate(said, 1)]
    assert story.scene_changes == 3
    assert "3 times" in Page([read_evidence(path)]).html()
