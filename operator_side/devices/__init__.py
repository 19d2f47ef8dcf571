"""Devices on the operator's host, read by programs of their own that send Steering to the operator's program."""
