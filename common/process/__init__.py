"""What every program does around its loop."""
