"""Kernels of coverings with boxes."""
