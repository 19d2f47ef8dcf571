"""`farhand trial guard`: hostile runs of every robot under the guard, judged by exact distances.

Runs that are there already are kept: a trial that was stopped goes on with the same --out.
"""

import json
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from pathlib import Path

import msgspec
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn, TimeRemainingColumn

from farhand.common.errors import InputError
from farhand.common.process.outputs import hold_folder, make_folder
from farhand.common.result_file import write_whole
from farhand.common.seeds import stream
from farhand.laboratory.campaigns.pools import LocalPool
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.trials.safety.adversary import MODES
from farhand.trials.safety.arm_run import run_arm
from farhand.trials.safety.outcome import Case, Outcome
from farhand.trials.safety.sphere_run import run_sphere

ABOUT, ROWS, TABLE = "trial.json", "runs.jsonl", "guard.md"
ARMS, SPHERES = ("ur5", "panda"), ("point", "box")
RUNS = {"ur5": 1000, "panda": 300, "point": 2000, "box": 2000}
"""Of each robot among what stands; of those that move, a tenth at each speed."""
SPEEDS = (0.0, 0.1, 0.3, 0.5)
"""Of movers (m/s)."""
A_SCENE = 5
"""Runs in one scene: one of each mode."""
ERRORS = (0.0, 0.5, -0.5)
ACCELERATIONS = (0.0, 0.5, 1.0, 2.0)
"""Of points (m/s^2); 0: no bound."""


@dataclass(frozen=True, slots=True)
class Trial:
    """Attributes:
    robots: which.
    share: of the runs of RUNS.
    speeds: of movers (m/s).
    seed: of all that is drawn.
    guarded: off shows what the commands do without.
    duration: of a run (s).
    """

    robots: tuple[str, ...] = (*ARMS, *SPHERES)
    share: float = 1.0
    speeds: tuple[float, ...] = SPEEDS
    seed: int = 1
    guarded: bool = True
    duration: float = 20.0

    def cases(self) -> list[Case]:
        """All runs, robots and speeds one after the other."""
        return [case for robot in self.robots for speed in self.speeds for case in self._cases(robot, speed)]

    def _cases(self, robot: str, speed: float) -> list[Case]:
        count = max(1, round(self.share * RUNS[robot] * (0.1 if speed else 1.0)))
        found = []
        for index in range(count):
            draw = stream(self.seed, "guard", robot, "case", f"{speed:g}", str(index))
            lag, acceleration = (ERRORS[int(draw.integers(3))] for _ in range(2))
            bound = ACCELERATIONS[int(draw.integers(4))] if robot == "point" else 0.0
            found.append(
                Case(
                    robot=robot,
                    index=index,
                    scene=index // A_SCENE,
                    speed=speed,
                    mode=MODES[index % len(MODES)],
                    lag_error=lag,
                    acceleration_error=acceleration,
                    acceleration=bound,
                    guarded=self.guarded,
                    duration=self.duration,
                )
            )
        return found

    def about(self) -> dict[str, object]:
        """What decides the runs; a folder holds one trial."""
        return {"seed": self.seed, "guarded": self.guarded, "duration": self.duration}


def run_case(seed: int, case: Case) -> Outcome:
    """Run one; what raises becomes an outcome with `error`."""
    run = run_arm if case.robot in ARMS else run_sphere
    try:
        return run(seed, case, GuardSettings())
    except Exception as error:
        return Outcome(case=case, error=f"{type(error).__name__}: {error}")


def run_trial(trial: Trial, out: Path, workers: int) -> int:
    """Run what is missing, print the table; returns 0, or 1 where anything came nearer than d_min among what stands."""
    console = Console(markup=False)
    done = _open(trial, out)
    cases = trial.cases()
    missing = [case for case in cases if case.key not in done]
    if len(missing) < len(cases):
        console.print(f"going on: {len(cases) - len(missing)} of {len(cases)} runs are there already")
    _run(trial.seed, missing, done, out / ROWS, workers, console)
    outcomes = [done[case.key] for case in cases if case.key in done]
    text = table(outcomes)
    write_whole(out / TABLE, text)
    console.print(text, markup=False, highlight=False, soft_wrap=True)
    console.print(f"kept in {out}/: {ROWS}, {TABLE}", highlight=False)
    d_min = GuardSettings().d_min
    return 1 if any(o.violates(d_min) for o in outcomes if o.case.speed <= 0.3) else 0


def _open(trial: Trial, out: Path) -> dict[str, Outcome]:
    make_folder(out, "--out")
    hold_folder(out, "--out")
    about = out / ABOUT
    if about.exists():
        if json.loads(about.read_text(encoding="utf-8")) != trial.about():
            raise InputError(f"--out {out}: holds another trial; choose another folder")
    else:
        write_whole(about, json.dumps(trial.about()) + "\n")
    done: dict[str, Outcome] = {}
    rows = out / ROWS
    for line in rows.read_text(encoding="utf-8").splitlines() if rows.exists() else ():
        try:
            outcome = msgspec.json.decode(line, type=Outcome)
        except msgspec.DecodeError:
            continue  # the last line of a trial that was killed; that run is done again
        done[outcome.case.key] = outcome
    return done


def _run(
    seed: int, missing: Sequence[Case], done: dict[str, Outcome], rows: Path, workers: int, console: Console
) -> None:
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    pool = LocalPool(workers)
    left = list(reversed(missing))
    with Progress(*columns, console=console) as bar, rows.open("a", encoding="utf-8") as kept:
        line = bar.add_task("", total=len(missing))
        with pool.open() as executor:
            running: set[Future[Outcome]] = set()
            while left or running:
                while left and len(running) < 2 * pool.width:
                    running.add(executor.submit(run_case, seed, left.pop()))
                ended, running = wait(running, return_when=FIRST_COMPLETED)
                for future in ended:
                    outcome = future.result()
                    done[outcome.case.key] = outcome
                    kept.write(msgspec.json.encode(outcome).decode() + "\n")
                    kept.flush()
                    bar.advance(line)


def table(outcomes: Sequence[Outcome]) -> str:
    """The table as Markdown, and below it every run that came too near."""
    d_min = GuardSettings().d_min
    lines = [
        "| robot | movers, m/s | runs | scenes | nearer than d_min | least, mm | least to itself, mm | "
        "guard acted, % | pinched runs | way, m |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    groups: dict[tuple[str, float, bool], list[Outcome]] = {}
    for outcome in outcomes:
        groups.setdefault((outcome.case.robot, outcome.case.speed, outcome.case.guarded), []).append(outcome)
    for (robot, speed, guarded), group in groups.items():
        bad = sum(o.violates(d_min) for o in group)
        itself = [1e3 * o.nearest_self for o in group if o.nearest_self is not None]
        cells = [
            robot if guarded else f"{robot}, guard off",
            f"{speed:g}" if speed else "none",
            len(group),
            len({o.case.scene for o in group}),
            bad,
            f"{1e3 * min(o.nearest for o in group):.1f}",
            f"{min(itself):.1f}" if itself else "–",
            f"{100 * sum(o.slowed for o in group) / len(group):.0f}",
            sum(o.pinched > 0 for o in group),
            f"{sum(o.travelled for o in group):.0f}",
        ]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    near = [o for o in outcomes if o.violates(d_min)]
    lines += [""] + [_why(outcome) for outcome in near[:100]]
    return "\n".join(lines).rstrip() + "\n"


def _why(outcome: Outcome) -> str:
    case = outcome.case
    if outcome.error:
        return f"- {case.key}: {outcome.error}"
    itself = (
        "" if outcome.nearest_self is None else f", {1e3 * outcome.nearest_self:.1f} mm between {outcome.two}"
    )
    return (
        f"- {case.key}, {case.mode}, lag {case.lag_error:+.0%}, acceleration {case.acceleration_error:+.0%}: "
        f"{outcome.part} {1e3 * outcome.nearest:.1f} mm to {outcome.obstacle} at {outcome.at:.2f} s{itself}: "
        f"{outcome.reason or 'near to itself'}"
    )
