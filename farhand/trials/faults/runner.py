"""Every fault and attack in turn, two tables, exit code 1 if any row is unsafe (`make faults`)."""

import argparse
import dataclasses
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from farhand.common.errors import FarhandError
from farhand.trials.faults.attacks import Attacked, attacks, perform
from farhand.trials.faults.breakages import Breakage, breakages
from farhand.trials.faults.judgement import Outcome
from farhand.trials.faults.rig import Rig
from farhand.trials.faults.tables import (
    ATTACK_HEADINGS,
    attack_row,
    fault_headings,
    fault_row,
    markdown,
    show,
)
from farhand.trials.hosts import why_not

Say = Callable[[str], None]
ARM_STANDS_WITHIN = 0.25
"""s, once nothing commands it: 0.2 s of its deadline, and what passes between the mark and the fault."""


def run_fault(rig: Rig, breakage: Breakage) -> Outcome | str:
    """What came of a fault; a text says why it was left out."""
    if breakage.missing:
        return breakage.missing
    breakage.prepare(rig)
    try:
        outcome, _ = rig.measure(lambda: breakage.run(rig))
    finally:
        breakage.clean_up(rig)
    if rig.has_controller and breakage.arm_stands and not stands_in_time(outcome):
        late = f"the arm did not stand within {ARM_STANDS_WITHIN:g} s"
        return dataclasses.replace(outcome, unsafe=(*outcome.unsafe, late))
    return outcome


def stands_in_time(outcome: Outcome) -> bool:
    """Whether the arm stood as soon as its controller's deadline has it stand."""
    return outcome.arm_stood is not None and outcome.arm_stood <= ARM_STANDS_WITHIN


def run_all(
    only: str, say: Say, kind: str, faults: dict[str, Outcome | str], attacked: list[Attacked]
) -> None:
    """Do the faults and attacks whose name holds `only`; what came of each is put into `faults` and `attacked`."""
    with tempfile.TemporaryDirectory() as folder:
        rig = Rig(Path(folder), kind=kind)
        try:
            for name, breakage in breakages().items():
                if only in name:
                    say(name)
                    faults[name] = run_fault(rig, breakage)
            for name, attack in attacks().items():
                if only in name:
                    say(name)
                    attacked.append(perform(rig, name, attack))
        finally:
            rig.hosts.close()


def main() -> int:
    """Run, print, and say by the exit code whether all was safe."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="faults and attacks whose name holds this")
    parser.add_argument("--list", action="store_true", help="only say what there is")
    parser.add_argument("--markdown", action="store_true", help="print the tables for docs/faults.md")
    parser.add_argument(
        "--robot", default="point", choices=("point", "ur"), help="ur: a UR5 behind an emulated controller"
    )
    options = parser.parse_args()
    names = [name for name in (*breakages(), *attacks()) if options.only in name]
    if options.list:
        print("\n".join(names))
        return 0
    problem = why_not() or (
        "" if names else f"--only {options.only!r}: no fault or attack is called so; see --list"
    )
    if problem:
        print(f"faults: {problem}", file=sys.stderr)
        return 2
    done = iter(range(1, len(names) + 1))
    faults: dict[str, Outcome | str] = {}
    attacked: list[Attacked] = []
    trouble = ""

    def say(name: str) -> None:
        print(f"{next(done)} of {len(names)}: {name}", file=sys.stderr, flush=True)

    try:
        run_all(options.only, say, options.robot, faults, attacked)
    except FarhandError as error:  # what was measured before is told all the same
        trouble = str(error)
        print(f"faults: {error}", file=sys.stderr)
    for headings, rows in (
        (fault_headings(options.robot), [fault_row(*fault, options.robot) for fault in faults.items()]),
        (ATTACK_HEADINGS, [attack_row(each) for each in attacked]),
    ):
        if rows and options.markdown:
            print(markdown(headings, rows))
        elif rows:
            show(headings, rows)
    safe = all(isinstance(o, str) or o.safe for o in faults.values()) and all(a.safe for a in attacked)
    return 0 if safe and not trouble else 1


if __name__ == "__main__":
    sys.exit(main())
