"""A hand at another program: what it says, who has the wheel, and hold-to-run; gamepad and SpaceMouse on top."""
