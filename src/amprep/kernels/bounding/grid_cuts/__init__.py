"""Kernels that cut solids into convex pieces along the planes of a rectilinear grid."""
