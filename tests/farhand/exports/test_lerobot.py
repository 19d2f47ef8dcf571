"""The LeRobot dataset: its own doctor is content, and an action is what was asked when the state beside it was seen."""

import json
import math

import av
import numpy as np
import pandas as pd
import pytest
from lerobot_doctor.dataset_loader import load_dataset
from lerobot_doctor.runner import Severity, run_checks

from farhand.common.errors import InputError
from farhand.exports.applied import Applied
from farhand.exports.axes import as_positions, axes_of, kept_axes
from farhand.exports.episodes import same_side
from farhand.exports.export import run_export
from farhand.testing import command, state
from tests.farhand.made_run import JOINTS, SIZE, STOPPED, TICK_NS, TICKS, make_run

KEY = "observation.images.camera"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lerobot")
    made = make_run(folder / "made.mcap", camera=True)
    assert run_export([folder / "made.mcap"], "lerobot", folder / "out") == 0
    return folder / "out", made


def frames_of(out):
    return pd.read_parquet(out / "data/chunk-000/file-000.parquet")


def column(frames, name):
    return np.stack(frames[name].to_numpy())


def test_the_doctor_has_no_complaint(dataset):
    out, _ = dataset
    report = run_checks(load_dataset(str(out)))
    assert [(each.name, each.messages) for each in report.results if each.severity is not Severity.PASS] == []


def test_an_action_is_what_was_asked_in_the_tick_that_saw_the_state(dataset):
    out, made = dataset
    frames = frames_of(out)
    ticks = range(1, TICKS)  # the first tick had seen nothing
    assert len(frames) == len(ticks)
    asked = [made.reports[tick].desired for tick in ticks]
    assert column(frames, "action") == pytest.approx(np.array(asked, dtype=np.float32))
    filtered = [made.reports[tick].filtered for tick in ticks]
    assert column(frames, "command.filtered") == pytest.approx(np.array(filtered, dtype=np.float32))
    seen = [made.states[5 * tick - 1] for tick in ticks]
    done = [(*each.velocity, *each.angular_velocity)[:3] for each in seen]
    assert column(frames, "observation.state") == pytest.approx(np.array(done, np.float32))
    place = np.array([(*each.position, *each.orientation, *each.joints) for each in seen], np.float32)
    told = column(frames, "observation.environment_state")
    assert np.delete(told, range(3, 7), axis=1) == pytest.approx(np.delete(place, range(3, 7), axis=1))
    turns = told[:, 3:7]
    assert np.abs(np.sum(turns * place[:, 3:7], axis=1)) == pytest.approx(1.0, abs=1e-5)
    assert (
        np.sum(turns[1:] * turns[:-1], axis=1) > 0.0
    ).all()  # q and -q are one: it never jumps between them
    sent = {each.seq: each for each in made.commands}
    for frame, at in zip(frames.to_dict("records"), seen, strict=True):
        followed = sent[at.applied_seq]
        assert frame["command.applied"] == pytest.approx(np.array(followed.velocity, np.float32))
    assert not np.allclose(column(frames, "command.applied"), column(frames, "action"))


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    folder = tmp_path_factory.mktemp("places")
    made = make_run(folder / "made.mcap", camera=True)
    assert run_export([folder / "made.mcap"], "lerobot", folder / "out", actions="position") == 0
    return folder / "out", made


def test_as_positions_an_action_is_where_what_was_asked_leads_from_what_was_seen(places):
    out, made = places
    frames = frames_of(out)
    asked = np.array([made.reports[tick].desired for tick in range(1, TICKS)])
    seen = np.array([made.states[5 * tick - 1].position for tick in range(1, TICKS)])
    assert column(frames, "observation.state") == pytest.approx(seen, abs=1e-6)
    assert column(frames, "action") == pytest.approx(seen + asked * TICK_NS * 1e-9, abs=1e-6)
    assert column(frames, "command.asked") == pytest.approx(asked, abs=1e-6)
    about = json.loads((out / "meta/info.json").read_text())["features"]
    assert about["action"]["names"] == about["observation.state"]["names"] == ["x", "y", "z"]


def test_as_positions_both_checkers_are_content(places):
    """Of lerobot-lint 0.1.1, which needs torch, the rules that judge an action and a state by themselves."""
    out, _ = places
    report = run_checks(load_dataset(str(out)))
    assert [each.name for each in report.results if each.severity is not Severity.PASS] == []
    frames = frames_of(out)
    for asked, seen in zip(column(frames, "action").T, column(frames, "observation.state").T, strict=True):
        assert np.corrcoef(asked, seen)[0, 1] >= 0.8
        assert np.abs(np.diff(seen)).max() <= 0.5 * np.ptp(seen)


def test_as_positions_what_turns_has_its_orientation():
    place = (0.1, 0.2, 0.3, -0.1, 0.7, 0.7, 0.1)
    values = {
        "action": (0.0, 0.1, 0.0, 0.0, 0.0, math.pi),
        "observation.environment_state": (*place, 1.0),
        "command.filtered": (0.0,) * 6,
        "command.applied": (0.0,) * 6,
    }
    found = as_positions(values, 0.5)
    assert found["action"][:3] == pytest.approx((0.1, 0.25, 0.3))
    turn = np.array(found["action"][3:])
    assert turn @ np.array(place[3:]) == pytest.approx(math.cos(math.pi / 4), abs=1e-3)
    assert found["observation.state"] == place
    rows = {name: np.array([each, np.array(each) * 1.5]) for name, each in found.items()}
    assert kept_axes(rows, axes_of("position"))["action"] == list(range(7))
    rows["command.asked"][:, 3:] = 0.0
    assert kept_axes(rows, axes_of("position"))["action"] == [0, 1, 2]


def test_an_orientation_does_not_jump_to_its_other_sign():
    assert same_side(None, (-0.7, 0.7, 0.1, 0.0)) == (0.7, -0.7, -0.1, 0.0)
    assert same_side((0.0, 0.7, 0.7, 0.0), (0.0, -0.7, -0.7, 0.01)) == (0.0, 0.7, 0.7, -0.01)
    assert same_side((0.0, 0.7, 0.7, 0.0), (0.0, 0.7, 0.7, 0.01)) == (0.0, 0.7, 0.7, 0.01)


def test_what_is_applied_follows_the_plan_and_is_nothing_where_the_robot_is_held():
    applied = Applied(7)
    sent = command(3, velocity=(0.3, 0, 0), plan=((0.2, 0, 0), (0.1, 0, 0)), plan_period_ns=100_000_000)
    applied.sent(sent)
    at = {"applied_session": 7, "applied_seq": 3}
    for held_ns, speed in (
        (0, 0.3),
        (99_000_000, 0.3),
        (100_000_000, 0.2),
        (250_000_000, 0.1),
        (300_000_000, 0.0),
    ):
        assert applied.at(state(applied_for_ns=held_ns, **at))[0][0] == speed
    assert applied.at(state(mode="hold", **at))[0] == (0, 0, 0)
    assert applied.at(state())[0] == (0, 0, 0)
    assert applied.at(state(applied_session=8, applied_seq=3)) is None


def test_indices_times_and_meta_agree(dataset):
    out, _ = dataset
    frames, about = frames_of(out), json.loads((out / "meta/info.json").read_text())
    assert (about["codebase_version"], about["fps"], about["total_frames"]) == ("v3.0", 10, TICKS - 1)
    assert list(frames.frame_index) == list(frames["index"]) == list(range(TICKS - 1))
    assert frames.timestamp.dtype == np.float32
    assert frames.timestamp.to_numpy() == pytest.approx(np.arange(TICKS - 1) / 10, abs=1e-5)
    assert (
        about["features"]["action"]["names"]
        == about["features"]["observation.state"]["names"]
        == ["x", "y", "z"]
    )
    assert about["features"]["observation.environment_state"]["names"][7:] == list(JOINTS)
    for name, feature in about["features"].items():
        if feature["dtype"] != "video":
            assert np.stack(frames[name].to_numpy()).reshape(len(frames), -1).shape[1] == feature["shape"][0]
    tasks = pd.read_parquet(out / "meta/tasks.parquet")
    assert tasks.index.tolist() == ["UR5 swings past a ball"]
    assert tasks.task_index.tolist() == [0]
    stats = json.loads((out / "meta/stats.json").read_text())
    assert stats["action"]["mean"] == pytest.approx(column(frames, "action").mean(axis=0), abs=1e-6)
    assert stats["action"]["std"] == pytest.approx(column(frames, "action").std(axis=0), abs=1e-6)
    episodes = pd.read_parquet(out / "meta/episodes/chunk-000/file-000.parquet")
    assert (episodes.dataset_from_index[0], episodes.dataset_to_index[0]) == (0, TICKS - 1)
    assert episodes[f"videos/{KEY}/to_timestamp"][0] == pytest.approx((TICKS - 1) / 10)


def test_the_video_shows_the_newest_picture_that_had_arrived(dataset):
    out, made = dataset
    with av.open(str(out / f"videos/{KEY}/chunk-000/file-000.mp4")) as video:
        pictures = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
        assert (video.streams.video[0].width, video.streams.video[0].height) == SIZE
        assert video.streams.video[0].average_rate == 10
    assert len(pictures) == TICKS - 1
    for index in (0, 1, 2, 31, 64, TICKS - 2):
        tick = index + 1
        errors = [np.abs(pictures[index].astype(int) - image).mean() for image in made.images]
        assert int(np.argmin(errors)) == tick // 2


def test_a_gap_ends_an_episode_and_idle_ends_are_cut(tmp_path, capsys):
    make_run(tmp_path / "a.mcap", left_out=range(30, 34))
    assert run_export([tmp_path / "a.mcap"], "lerobot", tmp_path / "out") == 1
    frames = frames_of(tmp_path / "out")
    assert frames.groupby("episode_index").size().tolist() == [
        29,
        TICKS - 36,
    ]  # for two ticks what is applied was sent in the gap
    assert frames.groupby("episode_index").timestamp.max().to_numpy() == pytest.approx(
        [2.8, (TICKS - 37) / 10]
    )
    said = capsys.readouterr().err  # and after the gap, what two ticks see applied was sent in it
    assert "4 ticks are missing after tick 29" in said
    assert "2 ticks are left out: the robot followed commands that are not in the recording" in said
    make_run(tmp_path / "b.mcap", ticks=STOPPED[-1] + 1)
    assert run_export([tmp_path / "b.mcap"], "lerobot", tmp_path / "b") == 0
    assert len(frames_of(tmp_path / "b")) == STOPPED[0] - 1


def test_several_runs_are_episodes_and_runs_of_two_kinds_are_refused(tmp_path):
    for name, ticks in (("a", 50), ("b", 60)):
        make_run(tmp_path / f"{name}.mcap", ticks=ticks)
    make_run(tmp_path / "camera.mcap", ticks=50, camera=True)
    a, b, camera = (tmp_path / f"{name}.mcap" for name in ("a", "b", "camera"))
    run_export([a, b], "lerobot", tmp_path / "out")
    frames = frames_of(tmp_path / "out")
    assert frames.groupby("episode_index").size().tolist() == [49, 59]
    assert list(frames["index"]) == list(range(108))
    with pytest.raises(
        InputError, match=r"a has 10 ticks/s, 6 joints, without pictures; camera has .* with pictures"
    ):
        run_export([a, camera], "lerobot", tmp_path / "no")
    assert not (tmp_path / "no").exists()
