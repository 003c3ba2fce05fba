"""Shadows of parts on the plate: as polygons with holes, and as convex pieces."""
