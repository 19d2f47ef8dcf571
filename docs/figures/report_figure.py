"""Draws docs/figures/report.png: `python docs/figures/report_figure.py`; needs Chromium."""

import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from farhand.laboratory.simulate_run import run_simulation
from farhand.runs.files import REPORT
from farhand.runs.run import Run
from farhand.runs.scenario import load_scenario

HERE = Path(__file__).resolve().parent


def main():
    """The top of the report of a simulated run."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made) / "run"
        run_simulation(Run.over(load_scenario("point-obstacle"), "5g-urban"), out=folder, as_json=False)
        subprocess.run(
            [
                *("chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"),
                f"--user-data-dir={made}/chromium",
                "--window-size=1000,1860",
                f"--screenshot={HERE / 'report.png'}",
                f"file://{folder / REPORT}",
            ],
            check=True,
        )


if __name__ == "__main__":
    main()
