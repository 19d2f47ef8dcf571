"""An operator's program that is followed while it runs: its ticks, its pictures, its silence."""
