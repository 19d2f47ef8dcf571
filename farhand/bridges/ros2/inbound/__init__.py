"""What comes from ROS: read, judged by its arrival, and held to run."""
