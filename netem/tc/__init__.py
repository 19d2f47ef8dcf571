"""The kernel's own emulation (tc-netem) in the words of a SPEC."""
