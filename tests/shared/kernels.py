"""Kernels as the Python functions that they are compiled from."""

from typing import Any


def plain(kernel: Any) -> Any:
    """Return the Python function of a kernel, also of one that only kernels call, and also without compilation."""
    return getattr(kernel, "py_func", kernel)
