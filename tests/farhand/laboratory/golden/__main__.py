"""Renew the golden values: run all, print what changed, keep it. Never run by a test."""

from pathlib import Path

import msgspec

from tests.farhand.laboratory.golden.golden import (
    VALUES,
    changed_bytes,
    differences,
    made_with,
    read_golden,
    run_golden,
    write_golden,
)


def renew(path: Path = VALUES) -> int:
    """Returns how many runs changed."""
    kept, here, changed = read_golden(path), made_with(), 0
    for line in differences(kept.made_with, here):
        print(f"made with {line}")
    found = []
    for run in kept.run:
        found.append(run_golden(run))
        lines = changed_bytes(run, found[-1])
        if lines:
            changed += 1
            print(run.name, *lines, sep="\n    ")
    write_golden(msgspec.structs.replace(kept, made_with=here, run=found), path)
    print(f"{changed} of {len(found)} runs changed; {path.name} says what they give now")
    return changed


if __name__ == "__main__":
    renew()
