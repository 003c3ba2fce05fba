"""Kernels for pictures of builds: rasterising and shading."""
