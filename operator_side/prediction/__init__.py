"""Prediction laws: where the robot will be when a command takes effect."""
