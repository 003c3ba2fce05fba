"""Prepares additive-manufacturing builds: packing, supports, lattice cells, 3MF build jobs."""

__version__ = "0.1.0"
