"""What a recording tells, in numbers and words: read once, and of one source each."""
