"""Formats of delay traces, one small file each."""
