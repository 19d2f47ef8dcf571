"""Recordings as files that other people's tools open: tables, a ROS 2 bag, a LeRobot dataset."""
