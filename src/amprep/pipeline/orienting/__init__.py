"""Propose orientations for parts: for ``amprep orient``, and for parts with ``rotations = "orient"``."""
