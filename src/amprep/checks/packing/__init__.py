"""Checks of packings, on the bounding volumes and on the meshes."""
