"""Compiled kernels on voxels."""
