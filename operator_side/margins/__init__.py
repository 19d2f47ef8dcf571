"""Margin laws: how much larger obstacles are made."""
