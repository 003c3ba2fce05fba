"""Neighbours of triangles, and contours of meshes in horizontal planes."""
