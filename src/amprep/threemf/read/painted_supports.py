"""Decode painted supports: blockers and enforcers on triangles, or on parts of triangles.

The code of a triangle is a tree of subdivisions in hexadecimal digits, written from the last digit to the first.
The lower two bits of a digit count the sides of the triangle that are halved. If there are none, the upper two
bits are the state of the whole triangle (3: the next digit holds a larger state). Otherwise the upper two bits are
the corner at which the subdivision starts, and the codes of the 2 to 4 smaller triangles follow, last triangle
first.
"""

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.model.counting import counted
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind
from amprep.threemf.package.painted_supports import PaintedSupports

MOST_DIGITS = 1_000_000
"""Digits read of one object; codes beyond them are counted as damaged."""

STATES: dict[int, RegionKind] = {1: "enforcer", 2: "blocker"}

# Corners and midpoints of the sides of a triangle that begins at the corner of the subdivision: a, b, c, ab, bc, ca.
_A, _B, _C, _AB, _BC, _CA = range(6)
_SUBDIVISIONS = {
    1: ((_A, _B, _BC), (_BC, _C, _A)),
    2: ((_A, _AB, _CA), (_AB, _B, _CA), (_B, _C, _CA)),
    3: ((_A, _AB, _CA), (_AB, _B, _BC), (_BC, _C, _CA), (_AB, _BC, _CA)),
}


def decode(code: str) -> tuple[Floats, Ints]:
    """Return the painted triangles within a triangle.

    Returns
    -------
    corners, states
        ``(k, 3, 3)`` in barycentric coordinates of the triangle, and ``(k,)`` keys of `STATES`.

    Raises
    ------
    ValueError
        If the code is truncated, has trailing data or names an invalid corner.
    """
    digits = [int(digit, 16) for digit in reversed(code)]
    stack = [np.eye(3)]
    painted: list[Floats] = []
    states: list[int] = []
    read = 0
    while stack:
        if read >= len(digits):
            raise ValueError("the code is truncated")
        corners, digit = stack.pop(), digits[read]
        read += 1
        sides, high = digit & 3, digit >> 2
        if sides:
            if high == 3:
                raise ValueError("the code names a fourth corner")
            stack += _subdivide(corners, sides, high)
            continue
        if high == 3:
            if read >= len(digits):
                raise ValueError("the code is truncated")
            high += digits[read]
            read += 1
        if high in STATES:
            painted.append(corners)
            states.append(high)
    if read < len(digits):
        raise ValueError("the code has trailing data")
    return np.array(painted).reshape(-1, 3, 3), np.array(states, np.int32)


def _subdivide(corners: Floats, sides: int, start: int) -> list[Floats]:
    """Return the smaller triangles of a triangle with 1 to 3 sides halved; the code lists them in reverse."""
    a, b, c = np.roll(corners, -start, axis=0)
    points = (a, b, c, (a + b) / 2, (b + c) / 2, (c + a) / 2)
    return [np.array([points[corner] for corner in triangle]) for triangle in _SUBDIVISIONS[sides]]


def painted_regions(
    painted: PaintedSupports, vertices: Floats, triangles: Ints, printed: Bools, first: int
) -> tuple[list[Region], str]:
    """Return the regions painted on an object's mesh, and a note if some could not be read.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``, corners in the order of the file.
    printed
        ``(m,)`` whether each triangle becomes part of the mesh.
    first
        Index in the part's mesh of the first printed triangle.

    Returns
    -------
    regions, note
        The note is empty if everything was read.
    """
    if painted.triangles != len(triangles):
        return [], "painted supports are dropped: lib3mf skipped some triangles of the object"
    index_in_part = first + np.cumsum(printed) - 1
    whole: dict[int, list[int]] = {state: [] for state in STATES}
    owners: dict[int, list[Ints]] = {state: [] for state in STATES}
    corners: dict[int, list[Floats]] = {state: [] for state in STATES}
    damaged, remaining = 0, MOST_DIGITS
    for index, code in painted.codes.items():
        remaining -= len(code)
        try:
            smaller, states = decode(code if remaining > 0 else "")
        except ValueError:
            damaged += 1
            continue
        for state in STATES if printed[index] else ():
            own = smaller[states == state]
            if len(code) == 1 and len(own):
                whole[state].append(int(index_in_part[index]))
            elif len(own):
                corners[state].append(own @ vertices[triangles[index]])
                owners[state].append(np.full(len(own), index_in_part[index]))
    regions = [
        Region(STATES[state], "painted", np.array(each, np.int32)) for state, each in whole.items() if each
    ]
    for state, each in corners.items():
        if each:
            points = np.concatenate(each).reshape(-1, 3)
            mesh = Mesh(points, np.arange(len(points)).reshape(-1, 3))
            regions.append(
                Region(STATES[state], "painted", np.concatenate(owners[state]).astype(np.int32), mesh)
            )
    note = (
        f"dropped painted supports of {counted(damaged, 'triangle')}: damaged or too fine" if damaged else ""
    )
    return regions, note
