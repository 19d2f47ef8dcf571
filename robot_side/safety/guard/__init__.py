"""The last barrier: what keeps the robot's whole body clear, on the true state, whatever the network brings."""
