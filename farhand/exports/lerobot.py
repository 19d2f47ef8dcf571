"""A LeRobotDataset v3.0: what was seen and what was asked, a frame a tick, an episode a run.

`action` is what the operator asked for in the tick in which it saw the observation beside it. What left the filter and
what the robot followed stand apart, under names that no training takes for actions: who learns from them learns the
network's lag.
"""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from farhand.common.errors import InputError, RunFileError
from farhand.common.geometry import Array
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick
from farhand.common.timing.clock import to_ns
from farhand.exports.axes import PLACE, POSITION, VELOCITY, Axes, as_positions, axes_of, kept_axes
from farhand.exports.episodes import Episode, Episodes, Frame, Values
from farhand.exports.source import Run, Source, has_pictures
from farhand.exports.statistics import Statistics
from farhand.exports.video import Video

Column = npt.NDArray[Any]
CAMERA_KEY = "observation.images.camera"
DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
VIDEOS = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
FLAGS = ("safety.intervening",)
INDEX = {"timestamp": "float32", "frame_index": "int64", "episode_index": "int64", "index": "int64",
         "task_index": "int64"}  # fmt: skip


def write_dataset(runs: Sequence[Run], folder: Path, *, actions: str = VELOCITY) -> list[Source]:
    """Write it; returns what was read of each run.

    Args:
        runs: which, an episode each.
        folder: to write into.
        actions: one of ACTIONS.

    Raises:
        RunFileError: a recording cannot be read, or holds nothing that was driven.
        InputError: the runs do not fit in one dataset.
    """
    look = [_look(run) for run in runs]
    if len({each.kind for each in look}) > 1:
        told = "; ".join(each.words() for each in look)
        raise InputError(f"--to lerobot: runs of one dataset are of one kind, but {told}")
    first = look[0]
    sources, episodes = [], list[Episode]()

    def form(values: Values) -> Values:
        return as_positions(values, 1.0 / first.fps) if actions == POSITION else values

    with ExitStack() as closing:
        video = Video(_video_path(folder), first.fps) if first.camera else None
        if video is not None:
            closing.callback(video.close)
        for run in runs:
            source = Source(run)
            sources.append(source)
            for episode in Episodes(source, to_ns(1.0 / first.fps), camera=first.camera).found():
                if video is not None:
                    video.add([frame.image for frame in episode.frames if frame.image is not None])
                episodes.append(
                    Episode(episode.task, [Frame(form(frame.values), None) for frame in episode.frames])
                )
    if not episodes:
        raise RunFileError(f"run {runs[0].path}: nothing was driven in it; expected commands in mode `run`")
    _Dataset(folder, episodes, first, video, axes_of(actions)).write()
    return sources


def _video_path(folder: Path) -> Path:
    return folder / VIDEOS.format(video_key=CAMERA_KEY, chunk_index=0, file_index=0)


class _Dataset:
    """Args:
    folder: to write into.
    episodes: all of them.
    look: what they have in common.
    video: of all of them; None: there is none.
    axes: of the features that share them.
    """

    def __init__(
        self,
        folder: Path,
        episodes: list[Episode],
        look: "_Look",
        video: Video | None,
        axes: tuple[Axes, ...],
    ) -> None:
        self._folder, self._episodes, self._look, self._video = folder, episodes, look, video
        self._tasks = list(dict.fromkeys(episode.task for episode in episodes))
        arrays = [_arrays(episode) for episode in episodes]
        whole = {name: np.concatenate([each[name] for each in arrays]) for name in arrays[0]}
        self._axes, self._kept = axes, kept_axes(whole, axes)
        self._values = [{name: each[name][:, kept] for name, kept in self._kept.items()} for each in arrays]

    def write(self) -> None:
        """All files but the video."""
        frames = [self._frames(number) for number in range(len(self._episodes))]
        statistics = [self._statistics(number, frame) for number, frame in enumerate(frames)]
        self._write_data(frames)
        self._write_episodes(statistics)
        self._write_tasks()
        whole = {name: Statistics.of([each[name] for each in statistics]) for name in statistics[0]}
        write_json(self._folder / "meta/stats.json", {name: each.plain() for name, each in whole.items()})
        write_json(self._folder / "meta/info.json", self._info())

    def _frames(self, number: int) -> dict[str, Column]:
        """The columns that every dataset has, of one episode."""
        count = len(self._episodes[number].frames)
        start = sum(len(each.frames) for each in self._episodes[:number])
        frame = np.arange(count, dtype=np.int64)
        return {
            "timestamp": (frame / self._look.fps).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(count, number, dtype=np.int64),
            "index": frame + start,
            "task_index": np.full(count, self._tasks.index(self._episodes[number].task), dtype=np.int64),
        }

    def _statistics(self, number: int, frames: dict[str, Column]) -> dict[str, Statistics]:
        found = {name: Statistics.measured(values) for name, values in self._values[number].items()}
        if self._video is not None:
            found[CAMERA_KEY] = self._video.statistics[number]
        return found | {name: Statistics.measured(values) for name, values in frames.items()}

    def _write_data(self, frames: list[dict[str, Column]]) -> None:
        import pyarrow as pa

        columns: dict[str, Any] = {}
        for name in self._values[0]:
            values = np.concatenate([each[name] for each in self._values]).astype(np.float32)
            if name in FLAGS:
                columns[name] = pa.array(values[:, 0] > 0.5)
            elif values.shape[1] == 1:
                columns[name] = pa.array(values[:, 0])
            else:
                columns[name] = pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])
        for name in frames[0]:
            columns[name] = pa.array(np.concatenate([each[name] for each in frames]))
        write_parquet(self._folder / DATA.format(chunk_index=0, file_index=0), pa.table(columns))

    def _write_episodes(self, statistics: list[dict[str, Statistics]]) -> None:
        import pyarrow as pa

        rows, start = [], 0
        for number, episode in enumerate(self._episodes):
            end = start + len(episode.frames)
            row: dict[str, Any] = {
                "episode_index": number,
                "tasks": [episode.task],
                "length": len(episode.frames),
                "data/chunk_index": 0,
                "data/file_index": 0,
                "dataset_from_index": start,
                "dataset_to_index": end,
                "meta/episodes/chunk_index": 0,
                "meta/episodes/file_index": 0,
            }
            if self._video is not None:
                key = f"videos/{CAMERA_KEY}"
                row |= {f"{key}/chunk_index": 0, f"{key}/file_index": 0}
                row |= {
                    f"{key}/from_timestamp": start / self._look.fps,
                    f"{key}/to_timestamp": end / self._look.fps,
                }
            for name, found in statistics[number].items():
                row |= {f"stats/{name}/{which}": value for which, value in found.plain().items()}
            rows.append(row)
            start = end
        write_parquet(self._folder / EPISODES, pa.Table.from_pylist(rows))

    def _write_tasks(self) -> None:
        """The task's words are the index, for those who read it with pandas."""
        import pyarrow as pa

        table = pa.table({"task_index": pa.array(range(len(self._tasks)), pa.int64()), "task": self._tasks})
        columns = [
            {"name": name, "field_name": name, "pandas_type": kind, "numpy_type": plain, "metadata": None}
            for name, kind, plain in (("task_index", "int64", "int64"), ("task", "unicode", "object"))
        ]
        told = {
            "index_columns": ["task"],
            "column_indexes": [],
            "columns": columns,
            "pandas_version": "2.2.0",
        }
        write_parquet(
            self._folder / "meta/tasks.parquet",
            table.replace_schema_metadata({"pandas": msgspec.json.encode(told)}),
        )

    def _info(self) -> dict[str, Any]:
        features: dict[str, Any] = {}
        for name, values in self._values[0].items():
            width = values.shape[1]
            kind = "bool" if name in FLAGS else "float32"
            features[name] = {"dtype": kind, "shape": [width], "names": self._names(name)}
        if self._video is not None:
            features[CAMERA_KEY] = self._video.feature()
        features |= {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in INDEX.items()}
        total = len(self._episodes)
        return {
            "codebase_version": "v3.0",
            "robot_type": self._look.robot,
            "total_episodes": total,
            "total_frames": sum(len(each.frames) for each in self._episodes),
            "total_tasks": len(self._tasks),
            "chunks_size": 1000,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "fps": self._look.fps,
            "splits": {"train": f"0:{total}"},
            "data_path": DATA,
            "video_path": VIDEOS if self._video is not None else None,
            "features": features,
        }

    def _names(self, feature: str) -> list[str]:
        shared = next((axes.names for axes in self._axes if feature in axes.features), None)
        if shared is not None:
            names: Sequence[str] = shared
        elif feature == "observation.environment_state":
            names = (*PLACE, *self._look.joints)
        else:
            names = (feature.rpartition(".")[2],)
        return [names[entry] for entry in self._kept[feature]]


def _arrays(episode: Episode) -> dict[str, Array]:
    names = episode.frames[0].values
    return {name: np.array([frame.values[name] for frame in episode.frames]) for name in names}


def write_parquet(path: Path, table: Any) -> None:
    """Write a table, and its folder."""
    import pyarrow.parquet as pq

    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path, compression="snappy")


def write_json(path: Path, value: Any) -> None:
    """Write it, and its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(msgspec.json.format(msgspec.json.encode(value), indent=4))


@dataclass(frozen=True, slots=True)
class _Look:
    """What must be the same in all runs of a dataset.

    Attributes:
        run: which.
        robot: its kind.
        fps: ticks a second.
        joints: their names; empty: none.
        camera: whether there are pictures.
    """

    run: Run
    robot: str
    fps: float
    joints: tuple[str, ...]
    camera: bool

    @property
    def kind(self) -> tuple[float, tuple[str, ...], bool]:
        """What must be the same."""
        return self.fps, self.joints, self.camera

    def words(self) -> str:
        """For people."""
        pictures = "with" if self.camera else "without"
        return f"{self.run.name} has {self.fps:g} ticks/s, {len(self.joints)} joints, {pictures} pictures"


def _look(run: Run) -> _Look:
    """The kind of a run, by the first tick that says it."""
    source = Source(run)
    try:
        camera = has_pictures(run)
        joints: tuple[str, ...] = ()
        robot = ""
        for item in source.items():
            if isinstance(item, DecodedTick):
                for _, _, message in item.arrived:
                    if isinstance(message, RobotState) and not joints:
                        joints = tuple(f"joint_{i}" for i in range(len(message.joints)))
                    if isinstance(message, RobotDescription):
                        robot, joints = message.model or message.kind, message.joint_names or joints
            if robot:
                break
        return _Look(run, robot or source.info.robot, _fps(source), joints, camera)
    finally:
        source.close()


def _fps(source: Source) -> float:
    period = source.info.tick_period
    if period is None or not 0.0 < period < 10.0:
        raise RunFileError(
            f"run {source.run.path}: its scenario has no controller.period; that is the rate of ticks"
        )
    rate = 1.0 / period
    return round(rate) if abs(rate - round(rate)) < 1e-6 else rate
