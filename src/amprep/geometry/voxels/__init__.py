"""Voxelisation of meshes."""
