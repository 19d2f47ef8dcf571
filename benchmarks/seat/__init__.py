"""The operator's seat: how soon a press leaves the operator, what the console costs, and whom it makes late.

`python -m benchmarks.seat [--json FILE] [--quick]`. Real programs on loopback, a page as the console hears one, and
Chromium where it is installed. Run it on an idle machine: the load average is printed beside every figure, and what was
measured under load says little.
"""

import argparse
import json
import os
from pathlib import Path
from typing import Any

from benchmarks.seat.answers import browser, press
from benchmarks.seat.late import late
from benchmarks.seat.lines import lines
from benchmarks.seat.share import share
from tests.operator_side.console.browser import CHROMIUM, DRIVER


def run(quick: bool) -> dict[str, Any]:
    """All measurements of one run; durations in s, shares of one core."""
    seconds = 4.0 if quick else 12.0
    return {
        "processors": os.cpu_count(),
        "share": {
            name: share(pages, obstacles, seconds)
            for name, pages, obstacles in (
                ("one page", 1, 3),
                ("300 obstacles", 1, 300),
                ("four pages", 4, 3),
            )
        },
        "press": press(12 if quick else 60),
        "browser": browser(8 if quick else 40) if CHROMIUM and DRIVER else None,
        "late": late(1 if quick else 3, 6.0 if quick else 15.0),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the results here as well")
    parser.add_argument("--quick", action="store_true", help="fewer and shorter, in a minute")
    options = parser.parse_args()
    found = run(options.quick)
    print(*lines(found), sep="\n")
    if options.json is not None:
        options.json.write_text(json.dumps(found, indent=2), encoding="utf-8")
