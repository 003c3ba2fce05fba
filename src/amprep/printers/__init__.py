"""The printer catalogue."""
