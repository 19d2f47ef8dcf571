"""A program starts fast: the command line loads what is heavy only in the command that needs it."""

import json
import subprocess
import sys

HEAVY = [
    "zenoh",
    "scipy",
    "matplotlib",
    "casadi",
    "pybullet",
    "pinocchio",
    "numba",
    "pyarrow",
    "distributed",
]


def test_the_command_line_loads_nothing_heavy():
    code = f"import farhand.cli, json, sys; print(json.dumps([m for m in {HEAVY} if m in sys.modules]))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert json.loads(found.stdout) == []
