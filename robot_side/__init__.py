"""The robot side: safety (intake, watchdog, lease, plan), velocity control, robots."""
