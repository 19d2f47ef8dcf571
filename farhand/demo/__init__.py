"""The demo: three programs as children of one, and their live status."""
