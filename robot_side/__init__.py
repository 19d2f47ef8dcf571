"""The robot side: watchdog, guard, velocity control, robot."""
