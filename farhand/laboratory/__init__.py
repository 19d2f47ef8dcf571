"""The same nodes in one process under a virtual clock."""
