"""Judges of support plans and support bodies."""
