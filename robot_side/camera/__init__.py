"""A program of its own beside the robot: pictures of it, or from a camera, to the operator."""
