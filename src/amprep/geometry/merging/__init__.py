"""Merging of lattice cells on the grid."""
