"""What the operator's side keeps and leaves behind: the newest ticks for a recorder, a result at the end."""
