"""Names of the files in a run's folder."""

SCENARIO, RECORDING, SUMMARY = "scenario.toml", "run.mcap", "summary.json"
OPERATOR, NETEM, ROBOT = "operator.json", "netem.json", "robot.json"
RESULTS = (OPERATOR, NETEM, ROBOT)
"""What the programs leave behind, one each."""
