"""Farhand as a node of a ROS 2 graph over rmw_zenoh, without a ROS installation."""
