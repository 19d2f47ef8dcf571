"""What breaks on a real network, done to the real programs in three network namespaces, and measured."""
