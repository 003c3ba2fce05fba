"""Tell whether values are indices, numbers, arrays and meshes."""

import math
from typing import Any

import numpy as np

from amprep.model.mesh import Mesh


def is_index(value: Any, count: int) -> bool:
    """Tell whether a value is a whole number from 0 to `count` - 1; a negative one would count from the end."""
    is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    return is_whole and 0 <= int(value) < count


def is_number(value: object) -> bool:
    """Tell whether a value is a finite real number."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def are_numbers(values: object, *shape: int) -> bool:
    """Tell whether values are an array of finite real numbers of a shape, in which -1 stands for any length."""
    if not isinstance(values, np.ndarray) or values.dtype.kind not in "fiu" or values.ndim != len(shape):
        return False
    fits = all(wanted in (-1, found) for wanted, found in zip(shape, values.shape, strict=True))
    return fits and bool(np.isfinite(values).all())


def are_indices(values: object, count: int) -> bool:
    """Tell whether values are a flat array of whole numbers from 0 to `count` - 1."""
    if not isinstance(values, np.ndarray) or values.dtype.kind not in "iu" or values.ndim != 1:
        return False
    return not len(values) or bool(values.min() >= 0 and values.max() < count)


def shown(value: object) -> str:
    """Return a value for a message, in one line of at most 60 characters."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # noqa: BLE001 the class of a stranger
        text = type(value).__name__
    return text if len(text) <= 60 else text[:57] + "..."


def fault_of_mesh(mesh: Any) -> str:
    """Return what is wrong with a mesh: its type, an index or a coordinate; empty if nothing is."""
    if not isinstance(mesh, Mesh):
        return f"{shown(mesh)}, expected a Mesh"
    if not are_numbers(mesh.vertices, -1, 3):
        return "a mesh with coordinates that are not finite"
    if mesh.triangles.ndim != 2 or not are_indices(mesh.triangles.reshape(-1), len(mesh.vertices)):
        return f"a mesh with a vertex index outside 0 to {len(mesh.vertices) - 1}"
    return "" if len(mesh.triangles) else "a mesh without triangles"
