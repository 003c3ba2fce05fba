"""Compiled loops over the triangles of a part and the directions in which it may be built."""
