"""What Farhand says, on ROS topics."""
