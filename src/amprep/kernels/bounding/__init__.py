"""Compiled kernels of bounding volumes."""
