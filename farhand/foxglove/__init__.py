"""A run as Foxglove's own topics: into a recording, or live."""
