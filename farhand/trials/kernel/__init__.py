"""The kernel's own emulation of networks (tc-netem), compared with that of messages."""
