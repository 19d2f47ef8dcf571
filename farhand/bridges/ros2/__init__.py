"""Farhand as a node of a ROS 2 graph over rmw_zenoh, without a ROS installation."""

from pathlib import Path

RVIZ = Path(__file__).with_name("farhand.rviz")
"""What RViz shows of it."""
