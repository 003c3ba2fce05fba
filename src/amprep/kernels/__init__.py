"""Compiled kernels, numba only: plain arrays in, plain arrays out."""
