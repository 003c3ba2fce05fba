"""Geometry of lattice cells: struts, functions, ports, tiling."""
