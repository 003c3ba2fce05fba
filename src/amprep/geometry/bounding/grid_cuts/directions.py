"""Directions that triangulate the sphere."""

from functools import cache
from itertools import permutations, product

import numpy as np

from amprep.kernels.bounding.grid_cuts.records import Directions

BASES = ((1, 0, 0), (1, 1, 0), (1, 1, 1), (2, 1, 0), (2, 1, 1), (2, 2, 1))
"""Directions of which all follow by permutations and signs."""

TRIANGLES = ((0, 3, 4), (3, 1, 5), (4, 5, 2), (3, 5, 4))
"""Triangles between the bases; those of the whole sphere follow in the same way."""


@cache
def sphere_directions() -> Directions:
    """Return the directions to the corners, edges and faces of a cube, and those between neighbours of these."""
    known: dict[tuple[int, ...], int] = {}
    for base in BASES:
        for axes in sorted(set(permutations(base))):
            for signs in product((1, -1), repeat=3):
                direction = tuple(a * s for a, s in zip(axes, signs, strict=True))
                if direction > tuple(-c for c in direction):
                    known.setdefault(direction, len(known))
    normals = np.array(list(known), np.float64)
    half = len(known)
    known |= {tuple(-c for c in direction): half + k for direction, k in list(known.items())}
    triangles = []
    for axes in permutations(range(3)):
        for signs in product((1, -1), repeat=3):
            corners = [_placed(base, axes, signs) for base in BASES]
            for three in TRIANGLES:
                triangles.append(_outward([corners[k] for k in three], known))
    both = np.concatenate((normals, -normals))
    return Directions(normals, np.array(triangles, np.int32), np.linalg.inv(both[np.array(triangles)]))


def _placed(base: tuple[int, ...], axes: tuple[int, ...], signs: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(base[axes[k]] * signs[k] for k in range(3))


def _outward(corners: list[tuple[int, ...]], known: dict[tuple[int, ...], int]) -> list[int]:
    turned = corners if np.linalg.det(np.array(corners, np.float64)) > 0.0 else corners[::-1]
    return [known[corner] for corner in turned]
