"""Painted supports: what slicers write at triangles about blockers and enforcers, down to parts of triangles.

PrusaSlicer keeps them in ``slic3rpe:custom_supports``, Bambu Studio and OrcaSlicer in ``paint_supports``; lib3mf
does not pass either on. The text is a tree in hexadecimal digits, the last digit first: a digit's lower two bits
say how many sides of the triangle are halved; without any its upper two are the state (3: the next digit holds
more), else the corner that the halving starts from, and the 2 to 4 pieces follow, last piece first.
"""

import re
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.model.mesh import Mesh
from amprep.model.part import Region, RegionKind

MOST_PIECES = 1_000_000
"""Pieces read of one object; what is painted finer than that is no longer looked at."""

STATES: dict[int, RegionKind] = {1: "enforcer", 2: "blocker"}

_ELEMENT = re.compile(rb"<(?:\w+:)?(object|triangle)\b((?:[^<>\"']|\"[^\"]*\"|'[^']*')*)>")
_ID = re.compile(rb"(?:^|\s)id\s*=\s*[\"'](\d{1,9})[\"']")
_PAINT = re.compile(rb"(?:custom_supports|paint_supports)\s*=\s*[\"']([0-9A-Fa-f]+)[\"']")

# Corners and middles of sides of a triangle that begins at its special corner: a, b, c, ab, bc, ca.
_A, _B, _C, _AB, _BC, _CA = range(6)
_HALVES = {
    1: ((_A, _B, _BC), (_BC, _C, _A)),
    2: ((_A, _AB, _CA), (_AB, _B, _CA), (_B, _C, _CA)),
    3: ((_A, _AB, _CA), (_AB, _B, _BC), (_BC, _C, _CA), (_AB, _BC, _CA)),
}


class Painted(NamedTuple):
    """What is painted on an object: number of its triangles, and the text at each painted one."""

    triangles: int
    texts: dict[int, str]


def find_paint(model: bytes) -> dict[int, Painted]:
    """Return object id -> what is painted on it, from a model part that has been looked through."""
    found: dict[int, Painted] = {}
    if b"_supports" not in model:
        return found
    name, count, texts = -1, 0, dict[int, str]()
    for element in _ELEMENT.finditer(model):
        if element[1] == b"object":
            number = _ID.search(element[2])
            name, count, texts = int(number[1]) if number else -1, 0, {}
            continue
        paint = _PAINT.search(element[2])
        if paint:
            texts[count] = paint[1].decode("ascii")
        count += 1
        if texts:
            found[name] = Painted(count, texts)
    return found


def decode(text: str) -> tuple[Floats, Ints]:
    """Return the painted pieces of a triangle: corners ``(k, 3, 3)`` in its barycentric coordinates, states ``(k,)``.

    Raises
    ------
    ValueError
        If the text ends too early or goes on too long.
    """
    digits = [int(digit, 16) for digit in reversed(text)]
    waiting = [np.eye(3)]
    pieces: list[Floats] = []
    states: list[int] = []
    read = 0
    while waiting:
        if read >= len(digits):
            raise ValueError("it ends too early")
        corners, digit = waiting.pop(), digits[read]
        read += 1
        sides, high = digit & 3, digit >> 2
        if sides:
            if high == 3:
                raise ValueError("it names a fourth corner")
            waiting += _split(corners, sides, high)
            continue
        if high == 3:
            if read >= len(digits):
                raise ValueError("it ends too early")
            high += digits[read]
            read += 1
        if high in STATES:
            pieces.append(corners)
            states.append(high)
    if read < len(digits):
        raise ValueError("it goes on too long")
    return np.array(pieces).reshape(-1, 3, 3), np.array(states, np.int32)


def _split(corners: Floats, sides: int, special: int) -> list[Floats]:
    """Return the pieces of a triangle with so many sides halved, in order; the last is the first in the text."""
    a, b, c = np.roll(corners, -special, axis=0)
    points = (a, b, c, (a + b) / 2, (b + c) / 2, (c + a) / 2)
    return [np.array([points[corner] for corner in piece]) for piece in _HALVES[sides]]


def painted_regions(
    painted: Painted, vertices: Floats, triangles: Ints, printed: Bools, first: int
) -> tuple[list[Region], str]:
    """Return what is painted on an object's mesh as regions, and what could not be read of it, in words.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``, corners in the order of the file.
    printed, first
        ``(m,)`` which of the triangles become part of the mesh, and the number of the first of these there.
    """
    if painted.triangles != len(triangles):
        return [], "painted supports are not kept: lib3mf left out some of its triangles"
    number = first + np.cumsum(printed) - 1
    wholes: dict[int, list[int]] = {state: [] for state in STATES}
    owners: dict[int, list[Ints]] = {state: [] for state in STATES}
    pieces: dict[int, list[Floats]] = {state: [] for state in STATES}
    broken, left = 0, MOST_PIECES
    for index, text in painted.texts.items():
        left -= len(text)
        try:
            parts, states = decode(text if left > 0 else "")
        except ValueError:
            broken += 1
            continue
        for state in STATES if printed[index] else ():
            own = parts[states == state]
            if len(text) == 1 and len(own):
                wholes[state].append(int(number[index]))
            elif len(own):
                pieces[state].append(own @ vertices[triangles[index]])
                owners[state].append(np.full(len(own), number[index]))
    regions = [
        Region(STATES[state], "painted", np.array(each, np.int32)) for state, each in wholes.items() if each
    ]
    for state, each in pieces.items():
        if each:
            corners = np.concatenate(each).reshape(-1, 3)
            mesh = Mesh(corners, np.arange(len(corners)).reshape(-1, 3))
            regions.append(
                Region(STATES[state], "painted", np.concatenate(owners[state]).astype(np.int32), mesh)
            )
    words = f"painted supports of {broken} triangles are damaged or too fine and not kept" if broken else ""
    return regions, words
