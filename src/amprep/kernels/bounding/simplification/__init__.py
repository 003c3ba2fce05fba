"""Kernels that simplify closed surfaces outwards."""
