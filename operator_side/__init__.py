"""The operator's side: steering, prediction, margin, safety filter."""
