"""A program starts fast: it loads what is heavy only where it is needed, and where it is, before it is in a hurry."""

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
CODE = f"""
import json, sys
def loaded():
    return [name for name in {HEAVY} if name in sys.modules]
import farhand.cli
line = loaded()
import farhand.programs.netem, farhand.programs.console, farhand.site.scene
print(json.dumps([line, loaded()]))
"""


def test_the_command_line_loads_nothing_heavy_and_what_neither_moves_nor_decides_no_numerics():
    found = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert json.loads(found.stdout) == [[], ["zenoh"]]
