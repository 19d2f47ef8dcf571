"""What the operator's side tells: a report each tick, the newest ticks for a recorder, a result at the end."""
