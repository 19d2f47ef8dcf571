"""Where a running emulator is found."""

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7449"
"""Of live control."""
