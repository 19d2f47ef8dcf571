"""The front door and the laboratory: command line, demo, simulation, experiments."""
