"""Messages as bytes: the types of a distribution, and what is told so often that it is written by hand."""
