"""The arm: model, kinematics, limits, velocity control."""
