"""Trials of the whole stack on hosts in network namespaces."""
