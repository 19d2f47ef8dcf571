"""Steering devices."""
