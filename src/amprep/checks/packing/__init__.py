"""Judges of packings."""
