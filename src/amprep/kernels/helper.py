"""Decorator of compiled functions that only other compiled functions call."""

from numba import njit

helper = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Such functions compile faster without wrappers, and the caches of their callers contain them."""
