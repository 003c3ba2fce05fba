"""Compiled kernels of block building."""
