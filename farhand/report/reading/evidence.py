"""A run as a report has it: its recording, and what lies beside it in the folder."""

from dataclasses import dataclass, field
from pathlib import Path

from farhand.common.errors import ResultError
from farhand.common.recording.place import recording_at
from farhand.common.result_file import read_result
from farhand.report.reading.story import Story, read_story
from farhand.robot_side.result import RobotCounts, RobotResult
from farhand.runs.files import RECORDING, ROBOT, SUMMARY
from farhand.runs.summary import RunSummary, read_summary


@dataclass
class Evidence:
    """Attributes:
    name: of the run, for people.
    story: what the recording tells.
    summary: of the folder; None: there is none that can be used.
    robot: what the robot counted; None: unknown.
    lacks: a line about each thing that is missing.
    """

    name: str
    story: Story
    summary: RunSummary | None = None
    robot: RobotCounts | None = None
    lacks: list[str] = field(default_factory=list)

    @property
    def whole(self) -> bool:
        """Whether every tick of the run is in the recording, as far as anybody knows."""
        summary = self.summary
        return self.story.whole and (summary is None or summary.ticks in (0, self.story.ticks.rows))


def read_evidence(run: Path) -> Evidence:
    """A run by its folder or its recording alone; raises InputError where nothing can be read."""
    story = read_story(recording_at(run))
    folder = run.resolve() if run.is_dir() else None
    found = Evidence(name=_name(run.resolve()), story=story)
    if folder is None:
        found.lacks.append(_alone(run.resolve()))
    else:
        _read_summary(found, folder)
    found.lacks = [*story.lacks, *found.lacks]
    return found


def _alone(recording: Path) -> str:
    """What a recording cannot tell, and where it stands, if anywhere."""
    lacks = "this is the recording alone: whether the run was safe by the robot's own count, and the robot's loop, "
    folder = recording.parent
    if recording.name == RECORDING:
        for name in (SUMMARY, ROBOT):
            if (folder / name).is_file():
                return f"{lacks}are not in it; for these give the folder, {folder.name}, which has a {name}"
    return f"{lacks}are not in it, and beside it is nothing that has them"


def _name(run: Path) -> str:
    """Of the folder, or of the file, with its folder's where all are called the same."""
    return f"{run.parent.name}/{run.name}" if run.name == RECORDING else run.name


def _read_summary(found: Evidence, folder: Path) -> None:
    try:
        summary = read_summary(folder)
    except ResultError as error:
        found.lacks.append(str(error))
    else:
        if summary is None:
            found.lacks.append(
                f"there is no {SUMMARY}: whether the run was safe by the robot's own count is unknown"
            )
        else:
            if not _is_of(summary, found.story):
                found.lacks.append(f"{SUMMARY} is of another run than the recording: it was left out")
                return
            _compare(found, summary)
    if found.robot is None:
        try:
            found.robot = read_result(folder / ROBOT, RobotResult)
        except ResultError as error:
            found.lacks.append(str(error).removeprefix(f"{folder}/"))


def _is_of(summary: RunSummary, story: Story) -> bool:
    return (summary.scenario, summary.seed) == (story.info.scenario.get("name"), story.info.seed)


def _compare(found: Evidence, summary: RunSummary) -> None:
    """Use the summary, and say what it counts more."""
    story = found.story
    found.summary, found.robot = summary, summary.counts.robot
    if summary.ticks != story.ticks.rows and summary.ticks:
        found.lacks.append(
            f"the recording has {story.ticks.rows} ticks, the run had {summary.ticks}: figures are of what is recorded "
            "where no result is named as their source"
        )
    if summary.counts.operator is None:
        found.lacks.append("the operator's program left no result: task and duration are as last recorded")
    if summary.counts.robot is None:
        found.lacks.append("the robot's program left no result: of its loop nothing is known")
