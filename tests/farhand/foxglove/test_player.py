"""Playing a recording: every message once and in order; after a seek all that stood then."""

from contextlib import closing
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from farhand.common.errors import RunFileError
from farhand.common.recording.reader import Gap, RunReader
from farhand.foxglove.player import Player
from farhand.foxglove.recorded_topics import RecordedTopics
from farhand.foxglove.wire import Frames, Scene
from farhand.programs.foxglove import Lacks
from tests.farhand.made_run import make_run

STEP_NS = 33_000_000


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("made") / "made.mcap"
    make_run(path)
    return path


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    path = tmp_path_factory.mktemp("short") / "short.mcap"
    make_run(path, ticks=15)
    return path


@pytest.fixture
def playing(path):
    topics, said = RecordedTopics(path), []
    yield topics, Player(topics, lambda *each: said.append(each)), said
    topics.close()


def written(path, topics):
    names = [spec.topic for spec in topics.specs]
    items = RunReader(path).items()
    return [
        (item.log_ns, names.index(item.topic) + 1, item.data) for item in items if not isinstance(item, Gap)
    ]


def test_it_plays_every_message_once_in_the_order_of_time(path, playing):
    topics, player, said = playing
    player.seek(topics.start_ns)
    while not player.ended:
        player.advance(player.at_ns + STEP_NS)
    heard = [(log_ns, channel, data) for channel, log_ns, data in said]
    assert [each[0] for each in heard] == sorted(each[0] for each in heard)
    assert sorted(heard) == sorted(written(path, topics))


@pytest.mark.parametrize("seed", range(6))
def test_after_a_seek_all_that_stood_then_is_said_and_the_rest_follows(path, playing, seed):
    topics, player, said = playing
    at_ns = int(np.random.default_rng(seed).integers(topics.start_ns + 2 * 10**9, topics.end_ns))
    player.seek(at_ns)
    before = [each for each in written(path, topics) if each[0] <= at_ns]
    scene, frames = topics.number_of("/scene"), topics.number_of("/tf")
    newest = {channel: max(log_ns for log_ns, c, _ in before if c == channel) for _, channel, _ in before}
    assert {channel: log_ns for channel, log_ns, _ in said} == newest
    for channel, kind in ((scene, Scene), (frames, Frames)):
        whole, told = kind(), kind()
        for _, number, data in before:
            if number == channel:
                whole.take(data)
        told.take(next(data for c, _, data in said if c == channel))
        assert told.names == whole.names
        assert sorted(told._entities.items() if kind is Scene else told._transforms.items()) == sorted(
            whole._entities.items() if kind is Scene else whole._transforms.items()
        )
    said.clear()
    player.advance(topics.end_ns)
    rest = [each for each in written(path, topics) if each[0] > at_ns]
    assert sorted((log_ns, channel, data) for channel, log_ns, data in said) == sorted(rest)


def test_one_that_is_cut_off_or_damaged_plays_what_is_there(path, tmp_path):
    data = path.read_bytes()
    rng = np.random.default_rng(3)
    for number in range(40):
        broken = bytearray(data[: int(rng.integers(1, len(data)))] if number % 2 else data)
        if not number % 2:
            broken[int(rng.integers(len(broken)))] ^= 1 << int(rng.integers(8))
        file = tmp_path / f"{number}.mcap"
        file.write_bytes(broken)
        try:
            topics = RecordedTopics(file)
        except RunFileError as error:
            lines = str(error).count("\n")
            assert not lines
            continue
        said = []
        player = Player(topics, lambda *each, said=said: said.append(each))
        player.seek(topics.start_ns)
        player.advance(topics.end_ns)
        topics.close()
        assert said


def test_a_scene_is_put_together_from_its_updates_and_deletions():
    from foxglove.messages import (
        SceneEntity,
        SceneEntityDeletion,
        SceneEntityDeletionType,
        SceneUpdate,
        Timestamp,
    )

    at, gone = Timestamp(sec=1), SceneEntityDeletionType
    scene = Scene()
    scene.take(
        SceneUpdate(entities=[SceneEntity(id=name, frame_id="base") for name in ("a", "b", "c")]).encode()
    )
    scene.take(SceneUpdate(entities=[SceneEntity(id="b", frame_id="tool")]).encode())
    scene.take(
        SceneUpdate(deletions=[SceneEntityDeletion(timestamp=at, type=gone.MatchingId, id="a")]).encode()
    )
    assert scene.names == {b"b", b"c"}
    again = Scene()
    again.take(scene.whole())
    assert again.whole() == scene.whole()
    assert (
        scene.whole()
        == SceneUpdate(
            entities=[SceneEntity(id="b", frame_id="tool"), SceneEntity(id="c", frame_id="base")]
        ).encode()
    )
    scene.take(SceneUpdate(deletions=[SceneEntityDeletion(timestamp=at, type=gone.All, id="")]).encode())
    assert not scene.names


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 10**9), st.integers(0, 7))
@example(-1, 0)
def test_what_a_flipped_bit_took_away_is_told_of(short, tmp_path, place, bit):
    data = bytearray(short.read_bytes())
    place = data.index(b"/joints") if place < 0 else place % len(data)
    data[place] ^= 1 << bit
    damaged = tmp_path / "run.mcap"
    damaged.write_bytes(data)
    try:
        whole, _ = played(short)
        found, lacks = played(damaged)
    except RunFileError:
        return
    assert found == whole or lacks


def test_all_damage_is_told_before_anything_is_played(path, tmp_path, capsys):
    data = bytearray(path.read_bytes())
    with closing(RecordedTopics(path)) as topics:
        places = [topics.chunks[number].start + topics.chunks[number].size - 9 for number in (3, -2)]
    for place in places:
        data[place] ^= 1
    damaged, heard = tmp_path / "run.mcap", []
    damaged.write_bytes(data)
    with closing(RecordedTopics(damaged)) as topics:
        lacks = Lacks("run.mcap", topics, SimpleNamespace(trouble=heard.append))
        while not topics.checked:
            lacks.tell(asked=False)
        line = "2 damaged parts of the file are left out"
        assert capsys.readouterr().err.splitlines() == [f"foxglove: run.mcap: {line}"]
        assert heard == [line]
        lacks.tell(asked=False)
        lacks.tell(asked=True)
        assert heard == [line] * 2
        assert not capsys.readouterr().err


def played(path):
    """All that a recording says by topic and time, and what is said to be missing."""
    said = []
    with closing(RecordedTopics(path)) as topics:
        player = Player(
            topics, lambda number, at, data: said.append((topics.specs[number - 1].topic, at, data))
        )
        player.seek(topics.start_ns)
        player.advance(topics.end_ns)
    return sorted(said), topics.lacks
