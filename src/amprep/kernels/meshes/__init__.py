"""Compiled kernels on triangle meshes."""
