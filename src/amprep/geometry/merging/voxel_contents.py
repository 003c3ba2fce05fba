"""What voxels of the grid hold: cells cut where they pass from one voxel to the next, united once for each pattern."""

from collections.abc import Sequence
from functools import cache
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.cells.tiling import plate
from amprep.geometry.merging.interfaces import Seam, seam
from amprep.geometry.merging.nonmanifold_edges import crowded_ends
from amprep.geometry.merging.union import arrays_of, evaluated
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import count_edges
from amprep.geometry.meshes.welding import cancel_opposite, label_equal_rows

if TYPE_CHECKING:
    from manifold3d import Manifold


LATTICE = 1 << 24
"""Steps along the side of a voxel: all corners lie on this lattice, so copies in neighbouring voxels agree exactly."""

_NEAR = 8
"""Steps: corners on sides of voxels that are this close are the same."""

SIDES = range(6)
"""Of a voxel: 2 axis, and 1 more for the far one."""


class Piece(NamedTuple):
    """What one voxel holds, as a closed mesh.

    Attributes
    ----------
    points
        ``(n, 3)`` in steps of the lattice; first those that nothing outside can touch.
    inner
        How many these are.
    parts
        Triangles: of inner points alone, with one other corner, with more, then those that lie in each of the
        six sides.
    outlines
        Number of the outline of what lies in each side; 0 where nothing does. The same on opposite sides
        means that the same is there.
    """

    points: Int64s
    inner: int
    parts: tuple[Int64s, ...]
    outlines: tuple[int, ...]


class Pieces:
    """Makes pieces and what their sides come to, each once.

    Parameters
    ----------
    templates
        Closed meshes in the unit cube.

    Attributes
    ----------
    items
        What cells fill of single voxels, as meshes.
    made
        All pieces there are yet.
    """

    def __init__(self, templates: Sequence[MeshArrays]) -> None:
        self.templates = list(templates)
        self._plates: dict[float, int] = {}
        self._corners: dict[tuple[int, int, int], tuple[int, int, int]] = {}
        self._buckets: dict[tuple[int, ...], list[tuple[int, int, int]]] = {}
        self._items: dict[tuple[int, ...], int] = {}
        self.items: list[MeshArrays] = []
        self._united = cache(self._unite)
        self._number: dict[bytes, int] = {}
        self._outline_number: dict[bytes, int] = {b"": 0}
        self._outlines: list[Int64s] = [np.empty((0, 2, 2), np.int64)]
        self._seams: dict[tuple[int, int], Seam | None] = {}
        self.made: list[Piece] = []

    def plate(self, thickness: float) -> int:
        """Number the template of a plate, see `amprep.geometry.cells.tiling.plate`."""
        if thickness not in self._plates:
            self._plates[thickness] = len(self.templates)
            self.templates.append(plate(thickness))
        return self._plates[thickness]

    def item(self, template: int, shift: tuple[int, int]) -> tuple[int, int]:
        """Number what a cell fills of the voxel of its upper square, and of that of its lower one (or -1)."""
        key = (template, *shift)
        if (*key, 0) not in self._items:
            for far, mesh in enumerate(self._halves(template, shift)):
                self._items[(*key, far)] = len(self.items)
                self.items.append(mesh)
        return self._items[(*key, 0)], self._items.get((*key, 1), -1)

    def _halves(self, template: int, shift: tuple[int, int]) -> list[MeshArrays]:
        """Cut a sheared template where it passes into the next voxel."""
        points, triangles = self.templates[template]
        points = np.round(points * LATTICE)
        if shift == (0, 0):
            return [(self._settled(points), triangles)]
        moved = points.copy()
        moved[:, :2] += (LATTICE - points[:, 2:]) * shift
        axis = 0 if shift[0] else 1
        outward = np.zeros(3)
        outward[axis] = shift[axis]
        beyond, within = as_manifold(moved, triangles).split_by_plane(
            outward.tolist(), LATTICE if shift[axis] > 0 else 0
        )
        (near, faces), (far, far_faces) = arrays_of(within), arrays_of(beyond)
        far = far - np.array([*shift, 0]) * LATTICE
        return [(self._settled(near), faces), (self._settled(far), far_faces)]

    def _settled(self, points: Floats) -> Floats:
        """Round to the lattice; of corners on sides that are nearly the same, in any piece, the first one counts."""
        rounded = np.round(points)
        rounded[np.abs(rounded) <= _NEAR] = 0.0
        rounded[np.abs(rounded - LATTICE) <= _NEAR] = LATTICE
        far = np.where(rounded == LATTICE, LATTICE, 0)
        near = (rounded - far).astype(np.int64)
        for index in np.flatnonzero((near == 0).any(axis=1)):
            near[index] = self._corner(*near[index].tolist())
        return np.asarray(near + far, np.float64)

    def _corner(self, x: int, y: int, z: int) -> tuple[int, int, int]:
        """Return the first corner that was as good as in this place."""
        if (x, y, z) in self._corners:
            return self._corners[x, y, z]
        found = (x, y, z)
        buckets = set(product(*({(each - _NEAR) >> 6, (each + _NEAR) >> 6} for each in found)))
        for corner in (corner for bucket in sorted(buckets) for corner in self._buckets.get(bucket, ())):
            pairs = list(zip(corner, (x, y, z), strict=True))
            if all(abs(a - b) <= _NEAR and (a == 0) == (b == 0) for a, b in pairs):
                found = corner
                break
        else:
            self._buckets.setdefault((x >> 6, y >> 6, z >> 6), []).append(found)
        self._corners[x, y, z] = found
        return found

    def piece(self, items: Int64s) -> int:
        """Number the piece that is the union of ascending items."""
        key = items.tobytes()
        if key not in self._number:
            mesh = self.items[items[0]]
            if len(items) > 1:
                mesh = arrays_of(self._united(tuple(items.tolist())))
            self._number[key] = len(self.made)
            self.made.append(self._sorted_out(*mesh))
        return self._number[key]

    def _unite(self, items: tuple[int, ...]) -> "Manifold":
        """Unite items one after the other: many patterns begin with the same ones."""
        if len(items) == 1:
            return as_manifold(*self.items[items[0]])
        return evaluated(self._united(items[:-1]) + self._united(items[-1:]))

    def _sorted_out(self, points: Floats, triangles: Int64s) -> Piece:
        settled = self._settled(points).astype(np.int64)
        label, count = label_equal_rows(settled)
        merged = np.empty((count, 3), np.int64)
        merged[label] = settled
        triangles = label[triangles]
        if count < len(points):
            triangles = triangles[cancel_opposite(triangles)]
        used, where = np.unique(triangles, return_inverse=True)
        merged, triangles = merged[used], where.reshape(-1, 3)
        outer = ((merged == 0) | (merged == LATTICE)).any(axis=1)
        crowded = crowded_ends(triangles)
        outer[crowded if crowded is not None else []] = True  # so that solids which touch there are parted
        order = np.argsort(outer, kind="stable")
        place = np.empty(len(order), np.int64)
        place[order] = np.arange(len(order))
        merged, triangles, inner = merged[order], place[triangles], int((~outer).sum())
        side = _sides(merged[triangles])
        outer_corners = (triangles >= inner).sum(axis=1)
        kind = np.where(side < 0, np.minimum(outer_corners, 2), 3 + side)
        parts = tuple(triangles[kind == each] for each in range(9))
        outlines = tuple(self._outlined(merged, parts[3 + each], each) for each in SIDES)
        return Piece(merged, inner, parts, outlines)

    def _outlined(self, points: Int64s, triangles: Int64s, side: int) -> int:
        """Number the outline of triangles in a side, seen against its axis."""
        if not len(triangles):
            return 0
        edges, _, balance = count_edges(triangles)
        turned = (balance > 0) == (side % 2 == 1)
        edges = np.where(turned[:, None], edges, edges[:, ::-1])[balance != 0]
        axis = side // 2
        outline = points[edges][:, :, [(axis + 1) % 3, (axis + 2) % 3]]
        outline = outline[np.lexsort(outline.reshape(-1, 4).T)]
        key = outline.tobytes()
        if key not in self._outline_number:
            self._outline_number[key] = len(self._outlines)
            self._outlines.append(outline)
        return self._outline_number[key]

    def seam(self, ours: int, theirs: int) -> Seam | None:
        """Return what two outlines come to that face each other."""
        if (ours, theirs) not in self._seams:
            self._seams[ours, theirs] = seam(self._outlines[ours], self._outlines[theirs])
        return self._seams[ours, theirs]


def _sides(corners: Int64s) -> Int64s:
    """Return which side of the voxel each triangle ``(m, 3, 3)`` lies in, or -1."""
    flush = np.stack([(corners == 0).all(axis=1), (corners == LATTICE).all(axis=1)], axis=2)
    flush = flush.reshape(len(corners), 6)
    return np.where(flush.any(axis=1), flush.argmax(axis=1), -1)
