"""Benchmark of collision queries on two parts: OBB trees, convex pieces, and other packages."""
