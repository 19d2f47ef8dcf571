"""Print what the programs need at run time, as pyproject.toml says: `runtime_requirements.py FILE`."""

import sys
from pathlib import Path

import tomllib


def requirements(pyproject: str) -> list[str]:
    """The dependencies of a pyproject.toml's text; what only tests and analyses need is among its extras."""
    wanted: list[str] = tomllib.loads(pyproject)["project"]["dependencies"]
    return wanted


if __name__ == "__main__":
    print("\n".join(requirements(Path(sys.argv[1]).read_text(encoding="utf-8"))))
