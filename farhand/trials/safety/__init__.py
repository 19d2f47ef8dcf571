"""Whether the robot keeps its distance: random tasks over lags, speeds and delays."""
