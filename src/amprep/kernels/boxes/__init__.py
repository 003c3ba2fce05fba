"""Compiled kernels that place boxes."""
