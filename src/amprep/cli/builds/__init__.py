"""Commands that take finished build jobs."""
