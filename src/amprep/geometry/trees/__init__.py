"""Collision meshes with OBB trees, and queries on them for arrays of poses (thesis 2.6)."""
