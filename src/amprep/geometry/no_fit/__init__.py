"""No-fit solids of pairs of shapes: as convex polyhedra, and sampled as fields of depth."""
