"""Campaigns in virtual time: the paper's table, sweeps, and what they have in common."""
