"""Points and vectors as tuples, which numba keeps in registers."""

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from numba import njit

Point = tuple[float, float, float]

Function = TypeVar("Function", bound=Callable[..., Any])


class Compiler(Protocol):
    """A decorator that keeps the type of the function."""

    def __call__(self, function: Function, /) -> Function:
        """Return the compiled function."""


kernel: Compiler = njit(cache=True, _nrt=False)
"""Compiles functions that create no arrays."""

inlined: Compiler = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False, forceinline=True)
"""Compiles functions that are inlined into kernels."""

part: Compiler = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
"""Compiles functions that only kernels call, and that are too long to be inlined."""


@inlined
def minus(a: Point, b: Point) -> Point:
    """Return ``a - b``."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def along(a: Point, direction: Point, t: float) -> Point:
    """Return ``a + t * direction``."""
    return a[0] + t * direction[0], a[1] + t * direction[1], a[2] + t * direction[2]


@inlined
def dot(a: Point, b: Point) -> float:
    """Return the scalar product."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@inlined
def cross(a: Point, b: Point) -> Point:
    """Return the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def normal_of(a: Point, b: Point, c: Point) -> Point:
    """Return the normal of a triangle; its length is twice the area."""
    return cross(minus(b, a), minus(c, a))
