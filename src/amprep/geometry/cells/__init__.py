"""Geometry of lattice cells: struts, implicit functions, ports, tiling, measurements."""
