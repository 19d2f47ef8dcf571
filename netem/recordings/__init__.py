"""Recorded delays: read, measure, summarise, replay."""
