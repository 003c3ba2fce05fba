"""Verify a build in memory or in a file, also against what was ordered."""
