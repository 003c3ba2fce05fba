"""Geometry of bounding volumes."""
