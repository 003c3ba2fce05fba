"""Decorators of compiled functions."""

from numba import njit

helper = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Compiles functions that only other compiled functions call.

They compile faster without wrappers, and the caches of their callers contain them.
"""

kernel = njit(cache=True, _nrt=False, error_model="numpy")
"""Compiles functions that create no arrays: without reference counts, which cost more than the work on records.

A division by zero gives infinity or not a number, as in numpy.
"""

uncounted = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
"""Compiles functions that only kernels call: without wrappers and reference counts, but not always inlined."""

inlined = njit(
    no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False, forceinline=True, error_model="numpy"
)
"""Compiles functions that only kernels call: inlined, so that they cost no call."""
