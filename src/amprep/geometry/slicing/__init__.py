"""Planar faces of meshes and the straight lines in which layers cut them."""
