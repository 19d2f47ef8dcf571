"""What a ROS node asks for: services, and parameters that are read-only."""
