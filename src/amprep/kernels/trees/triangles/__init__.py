"""Compiled kernels on pairs of triangles."""
