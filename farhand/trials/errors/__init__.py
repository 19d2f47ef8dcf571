"""The eight communication errors of IEC 61784-3, each injected: what is noticed, what moves, how soon it stands."""
