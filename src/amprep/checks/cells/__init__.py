"""Judges of lattice cells."""
