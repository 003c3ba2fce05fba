"""Compute the union of the cells in one voxel of the grid, once for each set of cells."""

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s, MeshArrays
from amprep.geometry.cells.tiling import plate
from amprep.geometry.merging.interfaces import Interface, make_interface
from amprep.geometry.merging.nonmanifold_edges import nonmanifold_vertices
from amprep.geometry.merging.union import arrays_of, evaluated
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import count_edges
from amprep.geometry.meshes.welding import cancel_opposite, label_equal_rows

if TYPE_CHECKING:
    from manifold3d import Manifold


RESOLUTION = 1 << 24
"""Lattice steps along the edge of a voxel. All corners are lattice points, so copies in neighbouring voxels agree
exactly."""

_NEAR = 8
"""Distance (lattice steps) within which corners on faces of voxels are taken as the same corner."""

_BUCKET_BITS = 6
"""Corners are found again by buckets of 2**6 lattice steps."""

FACES = range(6)
"""Faces of a voxel: 2 axis for the face on the low side, 2 axis + 1 for the face on the high side."""


class VoxelContents(NamedTuple):
    """Union of the cells in one voxel, as a closed mesh.

    Attributes
    ----------
    points
        ``(n, 3)`` lattice points. Inner points come first; nothing outside the voxel can touch them.
    inner
        Number of inner points.
    triangles
        Nine arrays of triangles: those with inner corners only, those with one other corner, those with more, and
        those in each of the six faces.
    outlines
        Number of the outline in each face; 0 if the face is empty. Equal outlines on opposite faces have equal
        numbers.
    """

    points: Int64s
    inner: int
    triangles: tuple[Int64s, ...]
    outlines: tuple[int, ...]


class ContentsTable:
    """Computes voxel contents and interfaces between them, each once.

    A voxel part is the portion of one cell inside one voxel. An oblique cell has two parts, because it passes from the
    voxel of its upper square into the voxel of its lower one; an upright cell has one.

    Parameters
    ----------
    templates
        Closed meshes in the unit cube.

    Attributes
    ----------
    parts
        Meshes of the voxel parts.
    contents
        All contents made so far.
    """

    def __init__(self, templates: Sequence[MeshArrays]) -> None:
        self.templates = list(templates)
        self.parts: list[MeshArrays] = []
        self.contents: list[VoxelContents] = []
        self._plates: dict[float, int] = {}
        self._corners: dict[tuple[int, int, int], tuple[int, int, int]] = {}
        self._buckets: dict[tuple[int, ...], list[tuple[int, int, int]]] = {}
        self._parts_of: dict[tuple[int, int, int], tuple[int, int]] = {}
        self._solids: dict[tuple[int, ...], Manifold] = {}
        self._contents_of: dict[bytes, int] = {}
        self._outline_number: dict[bytes, int] = {b"": 0}
        self._outlines: list[Int64s] = [np.empty((0, 2, 2), np.int64)]
        self._interfaces: dict[tuple[int, int], Interface | None] = {}

    def copy(self) -> "ContentsTable":
        """Return a table with the same contents; what is added to one of the two is not in the other."""
        other = ContentsTable(self.templates)
        other.parts, other.contents = list(self.parts), list(self.contents)
        other._plates, other._corners = dict(self._plates), dict(self._corners)
        other._buckets = {bucket: list(corners) for bucket, corners in self._buckets.items()}
        other._parts_of, other._solids = dict(self._parts_of), dict(self._solids)
        other._contents_of, other._interfaces = dict(self._contents_of), dict(self._interfaces)
        other._outline_number, other._outlines = dict(self._outline_number), list(self._outlines)
        return other

    def plate(self, thickness: float) -> int:
        """Return the number of the template of a plate, see `amprep.geometry.cells.tiling.plate`."""
        if thickness not in self._plates:
            self._plates[thickness] = len(self.templates)
            self.templates.append(plate(thickness))
        return self._plates[thickness]

    def parts_of(self, template: int, shift: tuple[int, int]) -> tuple[int, int]:
        """Return the numbers of a cell's parts: in the voxel of its upper square, and of its lower one (or -1).

        Parameters
        ----------
        template
            Number of the template.
        shift
            Step (dx, dy) from the upper square to the lower one.
        """
        key = (template, *shift)
        if key not in self._parts_of:
            made = self._cut(template, shift)
            first = len(self.parts)
            self.parts += made
            self._parts_of[key] = (first, first + 1 if len(made) > 1 else -1)
        return self._parts_of[key]

    def contents_of(self, parts: Int64s) -> int:
        """Return the number of the contents that are the union of parts, given in ascending order."""
        key = parts.tobytes()
        if key not in self._contents_of:
            mesh = self.parts[parts[0]]
            if len(parts) > 1:
                mesh = arrays_of(self._unite(tuple(parts.tolist())))
            self._contents_of[key] = len(self.contents)
            self.contents.append(self._classified(*mesh))
        return self._contents_of[key]

    def interface(self, low: int, high: int) -> Interface | None:
        """Return the interface of two outlines that face each other, see `make_interface`."""
        if (low, high) not in self._interfaces:
            self._interfaces[low, high] = make_interface(self._outlines[low], self._outlines[high])
        return self._interfaces[low, high]

    def _cut(self, template: int, shift: tuple[int, int]) -> list[MeshArrays]:
        """Shear a template and cut it where it passes into the next voxel."""
        points, triangles = self.templates[template]
        points = np.round(points * RESOLUTION)
        if shift == (0, 0):
            return [(self._rounded(points), triangles)]
        sheared = points.copy()
        sheared[:, :2] += (RESOLUTION - points[:, 2:]) * shift
        axis = 0 if shift[0] else 1
        outward = np.zeros(3)
        outward[axis] = shift[axis]
        beyond, within = as_manifold(sheared, triangles).split_by_plane(
            outward.tolist(), RESOLUTION if shift[axis] > 0 else 0
        )
        (upper, upper_triangles), (lower, lower_triangles) = arrays_of(within), arrays_of(beyond)
        lower = lower - np.array([*shift, 0]) * RESOLUTION
        return [(self._rounded(upper), upper_triangles), (self._rounded(lower), lower_triangles)]

    def _rounded(self, points: Floats) -> Floats:
        """Round to the lattice, and make nearly equal corners on faces equal in all parts and contents."""
        rounded = np.round(points)
        rounded[np.abs(rounded) <= _NEAR] = 0.0
        rounded[np.abs(rounded - RESOLUTION) <= _NEAR] = RESOLUTION
        far = np.where(rounded == RESOLUTION, RESOLUTION, 0)
        near = (rounded - far).astype(np.int64)
        for index in np.flatnonzero((near == 0).any(axis=1)):
            near[index] = self._corner(*near[index].tolist())
        return np.asarray(near + far, np.float64)

    def _corner(self, x: int, y: int, z: int) -> tuple[int, int, int]:
        """Return the first corner seen so far that is nearly equal to this one and on the same faces."""
        if (x, y, z) in self._corners:
            return self._corners[x, y, z]
        found = (x, y, z)
        buckets = set(
            product(*({(each - _NEAR) >> _BUCKET_BITS, (each + _NEAR) >> _BUCKET_BITS} for each in found))
        )
        for corner in (corner for bucket in sorted(buckets) for corner in self._buckets.get(bucket, ())):
            pairs = list(zip(corner, (x, y, z), strict=True))
            if all(abs(a - b) <= _NEAR and (a == 0) == (b == 0) for a, b in pairs):
                found = corner
                break
        else:
            bucket = (x >> _BUCKET_BITS, y >> _BUCKET_BITS, z >> _BUCKET_BITS)
            self._buckets.setdefault(bucket, []).append(found)
        self._corners[x, y, z] = found
        return found

    def _unite(self, parts: tuple[int, ...]) -> "Manifold":
        """Unite parts one after the other, because many sets begin with the same parts."""
        if parts not in self._solids:
            if len(parts) == 1:
                self._solids[parts] = as_manifold(*self.parts[parts[0]])
            else:
                self._solids[parts] = evaluated(self._unite(parts[:-1]) + self._unite(parts[-1:]))
        return self._solids[parts]

    def _classified(self, points: Floats, triangles: Int64s) -> VoxelContents:
        """Put inner points first and sort the triangles by their corners and faces."""
        corners, triangles = _merge_equal(self._rounded(points).astype(np.int64), triangles)
        outer = ((corners == 0) | (corners == RESOLUTION)).any(axis=1)
        nonmanifold = nonmanifold_vertices(triangles)
        # so that the solids that touch there are split together with those of other voxels
        outer[nonmanifold if nonmanifold is not None else []] = True
        order = np.argsort(outer, kind="stable")
        place = np.empty(len(order), np.int64)
        place[order] = np.arange(len(order))
        corners, triangles, inner = corners[order], place[triangles], int((~outer).sum())
        face = _faces(corners[triangles])
        outer_corners = (triangles >= inner).sum(axis=1)
        kind = np.where(face < 0, np.minimum(outer_corners, 2), 3 + face)
        by_kind = tuple(triangles[kind == each] for each in range(9))
        outlines = tuple(self._outline(corners, by_kind[3 + each], each) for each in FACES)
        return VoxelContents(corners, inner, by_kind, outlines)

    def _outline(self, points: Int64s, triangles: Int64s, face: int) -> int:
        """Return the number of the outline of triangles in a face, seen against the axis of the face."""
        if not len(triangles):
            return 0
        edges, _, balance = count_edges(triangles)
        turned = (balance > 0) == (face % 2 == 1)
        edges = np.where(turned[:, None], edges, edges[:, ::-1])[balance != 0]
        axis = face // 2
        outline = points[edges][:, :, [(axis + 1) % 3, (axis + 2) % 3]]
        outline = outline[np.lexsort(outline.reshape(-1, 4).T)]
        key = outline.tobytes()
        if key not in self._outline_number:
            self._outline_number[key] = len(self._outlines)
            self._outlines.append(outline)
        return self._outline_number[key]


def _merge_equal(points: Int64s, triangles: Int64s) -> tuple[Int64s, Int64s]:
    """Merge equal points, cancel triangles that coincide, and drop points that no triangle uses."""
    label, count = label_equal_rows(points)
    merged = np.empty((count, 3), np.int64)
    merged[label] = points
    triangles = label[triangles]
    if count < len(points):
        triangles = triangles[cancel_opposite(triangles)]
    used, number = np.unique(triangles, return_inverse=True)
    return merged[used], number.reshape(-1, 3)


def _faces(corners: Int64s) -> Int64s:
    """Return the face of the voxel that contains each triangle ``(m, 3, 3)``, or -1."""
    flush = np.stack([(corners == 0).all(axis=1), (corners == RESOLUTION).all(axis=1)], axis=2)
    flush = flush.reshape(len(corners), 6)
    return np.where(flush.any(axis=1), flush.argmax(axis=1), -1)
