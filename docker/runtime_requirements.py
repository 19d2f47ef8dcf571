"""Print what the programs need at run time, as pyproject.toml says: `runtime_requirements.py FILE`."""

import sys
from pathlib import Path

import tomllib

LABORATORY = {"pyarrow"}
"""Packages that only the analysis of experiments needs, which is not what containers are for."""


def requirements(pyproject: str) -> list[str]:
    """The dependencies of a pyproject.toml's text, less those of the laboratory."""
    wanted: list[str] = tomllib.loads(pyproject)["project"]["dependencies"]
    return [each for each in wanted if each.split(">")[0].split("=")[0].strip() not in LABORATORY]


if __name__ == "__main__":
    print("\n".join(requirements(Path(sys.argv[1]).read_text(encoding="utf-8"))))
