"""Convex pieces: decomposition of a solid, inflation, collision and distance."""
