"""All benchmarks in turn, each in a process of its own: `python -m benchmarks [NAME ...] [--quick] [--json FOLDER]`.

Figures are ratios and medians of one run, side by side; machines are shared, so compare nothing across runs.
"""

import argparse
import subprocess
import sys
from pathlib import Path

NAMES = (
    "messages",
    "solver",
    "operator_tick",
    "robot_loop",
    "arm_tick",
    "netem",
    "virtual_time",
    "virtual_parts",
    "seat",
    "recording",
    "report",
    "ros2",
)


def main() -> int:
    """Run the chosen benchmarks; returns the first exit code that is not 0."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)} [default: all]")
    parser.add_argument("--json", type=Path, metavar="FOLDER", help="write a JSON file for each as well")
    parser.add_argument(
        "--quick", action="store_true", help="to see that they work; the figures mean nothing"
    )
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in NAMES]
    if unknown:
        parser.error(f"unknown benchmark {unknown[0]!r}; there are {', '.join(NAMES)}")
    if options.json:
        options.json.mkdir(parents=True, exist_ok=True)
    worst = 0
    for name in options.names or NAMES:
        print(f"\n=== {name}", flush=True)
        arguments = ["--json", str(options.json / f"{name}.json")] if options.json else []
        arguments += ["--quick"] * options.quick
        code = subprocess.run(
            [sys.executable, "-m", f"benchmarks.{name}", *arguments], check=False
        ).returncode
        worst = worst or code
    return worst


if __name__ == "__main__":
    sys.exit(main())
