"""Convex pieces of solids, cut along the planes of a rectilinear grid."""
