"""Names of the files in a run's folder."""

from farhand.common.recording import place

RECORDING = place.RECORDING
SCENARIO, SUMMARY = "scenario.toml", "summary.json"
OPERATOR, NETEM, ROBOT = "operator.json", "netem.json", "robot.json"
RESULTS = (OPERATOR, NETEM, ROBOT)
"""What the programs leave behind, one each."""
FIGURE, FIGURE_PDF = "run.png", "run.pdf"
REPORT = "report.html"
LOGS = ("operator.log", "netem.log", "robot.log", "record.log", "console.log", "steer.log", "camera.log")
RUN_FILES = (SUMMARY, *RESULTS, RECORDING, SCENARIO, FIGURE, FIGURE_PDF, REPORT, *LOGS)
"""Everything that a run leaves in its folder."""
