"""Exact conservative voxelisation: which cubes of the support grid a mesh meets (thesis 3.2)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.overhangs.find import Bools, Floats, Ints, Longs, Overhangs

UNMARKED = 2**31 - 1
"""Label of a cube that holds nothing."""

_CONTACT = 1e-3
"""mm; the penetration that counts as contact."""


class Grid(NamedTuple):
    """Where cubes lie: cube (k, y, x) spans ``origin + (x, y, k) * (pitch, pitch, step)``, one size up.

    Attributes
    ----------
    origin
        ``(3,)`` mm.
    pitch, step
        Horizontal and vertical size of a cube, mm.
    shape
        Numbers of cubes ``(nz, ny, nx)``.
    """

    origin: Floats
    pitch: float
    step: float
    shape: tuple[int, int, int]

    def window(self, lo: Floats, hi: Floats, margin: float = 0.0) -> "Window":
        """Return the cubes that the box from `lo` to `hi`, widened sideways by `margin` mm, can touch."""
        size = np.array([self.pitch, self.pitch, self.step])
        wide = np.array([margin, margin, 0.0])
        first = np.floor((lo - wide - self.origin) / size).astype(np.int64) - 1
        last = np.ceil((hi + wide - self.origin) / size).astype(np.int64) + 1
        limit = np.array(self.shape[::-1])
        first, last = np.clip(first, 0, limit), np.clip(last, 0, limit)
        x, y, z = ((int(a), int(b)) for a, b in zip(first, np.maximum(first, last), strict=True))
        return Window(self, (z[0], y[0], x[0]), (z[1] - z[0], y[1] - y[0], x[1] - x[0]))


class Window(NamedTuple):
    """A block of a grid's cubes: `first` cube (k, y, x) and `shape`."""

    grid: Grid
    first: tuple[int, int, int]
    shape: tuple[int, int, int]

    @property
    def slices(self) -> tuple[slice, slice, slice]:
        """Index of the block in an array over the whole grid."""
        k, y, x = (slice(a, a + n) for a, n in zip(self.first, self.shape, strict=True))
        return k, y, x

    def relative(self, points: Floats) -> Floats:
        """Return `points` relative to the block's corner, mm."""
        size = (self.grid.pitch, self.grid.pitch, self.grid.step)
        corner = self.grid.origin + np.array(self.first[::-1]) * size
        return np.ascontiguousarray(points - corner, np.float64)


def met_cubes(window: Window, vertices: Floats, triangles: Ints, *, solid: bool = True) -> Bools:
    """Tell which cubes' open interior the solid meets, by its surface or its inside; an array over `window`.

    A penetration of up to 0.001 mm is contact and does not count, so a face on a grid plane leaves both
    sides alone (the inside then marks its own side). What is inside has a winding number above 0. With
    `solid` False only the surface counts.
    """
    from amprep.kernels.voxels.voxelise import count_crossings, mark_interior

    marks = _marked(window, vertices, triangles, grow=-_CONTACT, holds=False)
    if solid and marks.size:
        change = np.zeros(window.shape, np.int16)
        pitch, step = float(window.grid.pitch), float(window.grid.step)
        count_crossings(window.relative(vertices), _indices(triangles), pitch, step, change)
        mark_interior(change, marks)
    return np.asarray(marks != UNMARKED)


def near_cubes(window: Window, vertices: Floats, triangles: Ints, gap: float) -> Bools:
    """Tell which cubes have the surface in their sideways neighbourhood: the square widened by `gap` mm."""
    return np.asarray(_marked(window, vertices, triangles, grow=gap - _CONTACT, holds=False) != UNMARKED)


def holding_cubes(window: Window, vertices: Floats, triangles: Ints, overhangs: Overhangs) -> Ints:
    """Label the cubes that hold needy geometry with its least region, others with `UNMARKED`.

    A face, edge or tip on a horizontal grid plane belongs to the cube above it, the material's side; an edge
    or a tip on an upright grid plane to the cubes on both sides. Intersect with the black cubes to keep those
    that have material.
    """
    faces = triangles[overhangs.faces]
    marks = _marked(window, vertices, faces, grow=-_CONTACT, holds=True, labels=overhangs.face_region)
    thin = np.concatenate([overhangs.edges[:, [0, 1, 1]], overhangs.tips[:, None].repeat(3, axis=1)])
    labels = np.concatenate([overhangs.edge_region, overhangs.tip_region])
    return np.minimum(marks, _marked(window, vertices, thin, grow=_CONTACT, holds=True, labels=labels))


def _indices(triangles: NDArray[np.integer]) -> Longs:
    return np.ascontiguousarray(triangles, np.int64)


def _marked(
    window: Window, vertices: Floats, elements: Ints, *, grow: float, holds: bool, labels: Ints | None = None
) -> Ints:
    from amprep.kernels.voxels.voxelise import mark_elements

    marks = np.full(window.shape, UNMARKED, np.int32)
    if marks.size and len(elements):
        numbers = np.zeros(len(elements), np.int32) if labels is None else np.array(labels, np.int32)
        points = window.relative(vertices)
        pitch, step = float(window.grid.pitch), float(window.grid.step)
        mark_elements(points, _indices(elements), numbers, pitch, step, float(grow), _CONTACT, holds, marks)
    return marks
