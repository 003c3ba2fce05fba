"""Plan supports and build their solids."""
