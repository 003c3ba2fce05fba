"""Contours in which horizontal planes cut meshes, planar faces, and the straight lines in which layers cut them."""
