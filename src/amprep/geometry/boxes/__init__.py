"""Geometry of boxes in a build volume."""
