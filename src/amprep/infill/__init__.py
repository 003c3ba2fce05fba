"""Regions of parts that are filled with lattice cells."""
