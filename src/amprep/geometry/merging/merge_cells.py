"""Unite lattice cells of all directions on arrays."""

from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats, Int32s, Int64s
from amprep.geometry.merging.nonmanifold_edges import nonmanifold_vertices, split_vertices
from amprep.geometry.merging.shared_faces import (
    FilledVoxels,
    MatchedFaces,
    PlacedInterfaces,
    match_faces,
    place_interfaces,
)
from amprep.geometry.merging.t_junctions import split_at_points, split_on_grid_lines
from amprep.geometry.merging.voxel_contents import FACES, RESOLUTION, ContentsTable, VoxelContents
from amprep.geometry.meshes.welding import label_equal_rows

# Strategy. A lattice repeats few patterns many times, so Booleans are computed once per pattern and copied.
# 1. Each cell is cut into the parts that it fills of the voxels of the grid (one, or two for an oblique cell). Voxels
#    with the same set of parts have the same contents, and manifold3d unites each set once (`ContentsTable`).
#    All corners are rounded to an integer lattice, so that copies agree exactly.
# 2. The union of all voxels differs from the sum of their contents only in shared faces (`match_faces`): where
#    both voxels cover the same region, both faces vanish; where the regions differ, the difference stays, which is
#    computed once per pair of outlines (`place_interfaces`); all other faces stay.
# 3. Inner points and the triangles between them are copied by adding offsets (`_copy_inside`): nothing else can touch
#    them. This is the bulk of the data; it runs in a second thread, while
# 4. points on faces are merged by their lattice coordinates, and triangles are split at points on their edges, so that
#    no T-junction is left (`split_at_points`, `split_on_grid_lines`).
# 5. Edges in which solids merely touch are split (`split_vertices`), so that the result is a closed manifold.
# The result has the volume and topology of the exact union. The time is proportional to the number of triangles
# written, plus one Boolean per pattern; manifold3d alone takes over fifty times as long per cell
# (`amprep bench merging`).


class _Copies(NamedTuple):
    """Voxels ``(n,)`` with the same contents, and where their inner points and triangles begin."""

    contents: VoxelContents
    voxel: Int64s
    point: int
    triangle: int


class _Boundary(NamedTuple):
    """Triangles with corners on faces of voxels. Corners count all inner points first, then the shared points.

    Attributes
    ----------
    shared
        ``(s, 3)`` lattice points from the origin of the grid; several may be equal.
    near, rim
        Triangles with one shared corner, and with more.
    splits
        ``(r, 3)`` corners: two ends of an edge, and a point that the edge passes through.
    """

    shared: Int64s
    near: Int64s
    rim: Int64s
    splits: Int64s


def unite_cells(
    table: ContentsTable, template: Int64s, square: Int64s, shift: Int64s, origin: Floats, size: Floats
) -> tuple[Floats, Int64s] | None:
    """Return the union of cells as one closed mesh; None where outlines are too fine for the lattice.

    Parameters
    ----------
    table
        Templates of the cells, and the contents computed so far.
    template, square, shift
        Cells as for `fill_voxels`.
    origin, size
        ``(3,)`` mm: corner of the grid, and size of a voxel.
    """
    return unite_voxels(table, fill_voxels(table, template, square, shift), origin, size)


def fill_voxels(table: ContentsTable, template: Int64s, square: Int64s, shift: Int64s) -> FilledVoxels:
    """Find the voxels that cells pass through, and the contents of each.

    Parameters
    ----------
    template
        ``(n,)`` numbers of templates.
    square
        ``(n, 3)`` x, y, layer of the upper square of each cell.
    shift
        ``(n, 2)`` dx, dy from the upper square to the lower one: at most one step, in x or in y.
    """
    place, part = _parts_in_voxels(table, template, square, shift)
    low, extent = place.min(axis=0), np.ptp(place, axis=0) + 1
    voxel = (place - low) @ np.array([1, extent[0], extent[0] * extent[1]])
    count = len(table.parts)
    voxel, part = np.divmod(np.unique(voxel * count + part), count)
    starts = np.flatnonzero(np.diff(voxel, prepend=-1))
    sizes = np.diff(np.append(starts, len(voxel)))
    contents = np.empty(len(starts), np.int64)
    alone = sizes == 1
    for each in np.unique(part[starts[alone]]):
        contents[alone & (part[starts] == each)] = table.contents_of(np.array([each]))
    for index in np.flatnonzero(~alone):
        contents[index] = table.contents_of(part[starts[index] : starts[index] + sizes[index]])
    number = voxel[starts]
    place = np.column_stack(
        [number % extent[0], number // extent[0] % extent[1], number // extent[0] // extent[1]]
    )
    return FilledVoxels(low + place, contents)


def _parts_in_voxels(
    table: ContentsTable, template: Int64s, square: Int64s, shift: Int64s
) -> tuple[Int64s, Int64s]:
    """List all voxel parts of cells: the voxels ``(k, 3)``, and the numbers of the parts ``(k,)``."""
    _, first, kind = np.unique(
        9 * template + 3 * shift[:, 0] + shift[:, 1], return_index=True, return_inverse=True
    )
    made = [table.parts_of(int(template[each]), tuple(shift[each].tolist())) for each in first]
    parts = np.array(made, np.int64).reshape(-1, 2)
    oblique = parts[kind, 1] >= 0
    lower = square[oblique] + np.column_stack([shift[oblique], np.zeros(int(oblique.sum()), np.int64)])
    return np.concatenate([square, lower]), np.concatenate([parts[kind, 0], parts[kind[oblique], 1]])


def unite_voxels(
    table: ContentsTable, voxels: FilledVoxels, origin: Floats, size: Floats
) -> tuple[Floats, Int64s] | None:
    """Return the union of the contents of voxels as one closed mesh; None where it cannot be made on arrays.

    Parameters
    ----------
    table, voxels
        Contents, and where they are.
    origin, size
        ``(3,)`` mm: corner of the grid, and size of a voxel.
    """
    faces = match_faces(table, voxels)
    interfaces = place_interfaces(table, voxels, faces)
    if interfaces is None:
        return None
    copies = _copies(table, voxels)
    inner, closed = copies[-1].point, copies[-1].triangle
    points, triangles = _room(copies, interfaces)
    with ThreadPoolExecutor(1) as pool:
        copying = pool.submit(_copy_inside, copies, voxels.place, origin, size, points, triangles)
        shared, near, rim = _joined(_boundary(copies, voxels, faces, interfaces), inner)
        nonmanifold = nonmanifold_vertices(rim, inner)
        copying.result()
    if nonmanifold is None:
        return None
    last = inner + len(shared)
    points[inner:last] = origin + shared * (size / RESOLUTION)
    added, rim = split_vertices(points[:last], np.concatenate([near, rim]), nonmanifold)
    used = np.zeros(last + len(added), np.bool_)
    used[rim] = True
    _renumber(rim, inner, np.cumsum(used[inner:]) - 1)
    rest = np.concatenate([points[inner:last], added])[used[inner:]]
    return _appended(points, inner, rest), _appended(triangles, closed, rim)


def _copies(table: ContentsTable, voxels: FilledVoxels) -> list[_Copies]:
    """List the voxels of each contents; the last entry, without voxels, tells where points and triangles end."""
    used, which, count = np.unique(voxels.contents, return_inverse=True, return_counts=True)
    order = np.split(np.argsort(which, kind="stable"), np.cumsum(count)[:-1])
    listed: list[_Copies] = []
    point = triangle = 0
    for number, voxel in zip(used.tolist(), order, strict=True):
        contents = table.contents[number]
        listed.append(_Copies(contents, voxel, point, triangle))
        point += len(voxel) * contents.inner
        triangle += len(voxel) * len(contents.triangles[0])
    return [*listed, _Copies(contents, order[0][:0], point, triangle)]


def _room(copies: list[_Copies], interfaces: list[PlacedInterfaces]) -> tuple[Floats, Int32s]:
    """Return arrays large enough for all points and triangles, unless many vertices are split."""
    points = copies[-1].point + sum(len(each.corners) for each in interfaces)
    triangles = sum(len(each.triangles) for each in interfaces)
    for contents, voxel, _, _ in copies:
        points += len(voxel) * (len(contents.points) - contents.inner)
        triangles += len(voxel) * sum(map(len, contents.triangles))
    return np.empty((points, 3)), np.empty((triangles, 3), np.int32)


def _copy_inside(
    copies: list[_Copies], place: Int64s, origin: Floats, size: Floats, points: Floats, triangles: Int32s
) -> None:
    """Write the inner points of all voxels and the triangles between them into `points` and `triangles`.

    Parameters
    ----------
    place
        ``(v, 3)`` x, y, layer of each voxel.
    origin, size
        ``(3,)`` mm: corner of the grid, and size of a voxel.
    """
    for (contents, voxel, point, triangle), after in pairwise(copies):
        into = points[point : after.point].reshape(len(voxel), -1, 3)
        moved = (origin + place[voxel] * size)[:, None]
        np.add((contents.points[: contents.inner] * (size / RESOLUTION))[None], moved, out=into)
        starts = (point + contents.inner * np.arange(len(voxel), dtype=np.int32))[:, None, None]
        faces = triangles[triangle : after.triangle].reshape(len(voxel), -1, 3)
        np.add(contents.triangles[0][None].astype(np.int32), starts.astype(np.int32), out=faces)


def _boundary(
    copies: list[_Copies], voxels: FilledVoxels, faces: MatchedFaces, interfaces: list[PlacedInterfaces]
) -> _Boundary:
    """Copy the triangles with corners on faces of voxels, and add those of the interfaces."""
    shared, near, rim = [], [], []
    first = copies[-1].point
    for contents, voxel, point, _ in copies[:-1]:
        outer, inner = contents.points[contents.inner :], contents.inner
        shared.append((outer[None] + voxels.place[voxel][:, None] * RESOLUTION).reshape(-1, 3))
        number = np.arange(len(voxel))
        starts = np.column_stack([point + inner * number, first - inner + len(outer) * number])
        near.append(_copied(contents.triangles[1], inner, starts))
        rim.append(_copied(contents.triangles[2], inner, starts))
        rim += [
            _copied(contents.triangles[3 + face], inner, starts[faces.keep[voxel, face]]) for face in FACES
        ]
        first += len(outer) * len(voxel)
    return _Boundary(
        np.concatenate([*shared, *(each.corners for each in interfaces)]),
        np.concatenate(near),
        np.concatenate([*rim, *(each.triangles + first for each in interfaces)]),
        np.concatenate([np.empty((0, 3), np.int64), *(each.splits + first for each in interfaces)]),
    )


def _copied(triangles: Int64s, inner: int, starts: Int64s) -> Int64s:
    """Copy triangles; `starts` ``(n, 2)`` are added to their inner corners and to their outer corners."""
    outer = (triangles >= inner).astype(np.int64)
    return (triangles[None] + starts[:, outer]).reshape(-1, 3)


def _joined(boundary: _Boundary, inner: int) -> tuple[Int64s, Int64s, Int64s]:
    """Merge equal shared points, and split triangles at the points on their edges.

    Returns
    -------
    shared, near, rim
        Different lattice points, and the triangles of the boundary over them.
    """
    label, count = label_equal_rows(boundary.shared)
    shared = np.empty((count, 3), np.int64)
    shared[label] = boundary.shared
    _renumber(boundary.near, inner, label)
    _renumber(boundary.rim, inner, label)
    rim = split_at_points(boundary.rim, inner + label[boundary.splits - inner], inner + count)
    return shared, boundary.near, split_on_grid_lines(rim, shared, inner)


def _renumber(triangles: Int64s, first: int, number: Int64s) -> None:
    """Replace corner `first` + k by `first` + `number[k]`, in place."""
    flat = triangles.reshape(-1)
    outer = np.flatnonzero(flat >= first)
    flat[outer] = first + number[flat[outer] - first]


def _appended(room: NDArray[Any], count: int, rows: NDArray[Any]) -> NDArray[Any]:
    """Put rows after the first `count` rows of `room`, in place if they fit."""
    if count + len(rows) > len(room):
        return np.concatenate([room[:count], rows])
    room[count : count + len(rows)] = rows
    return room[: count + len(rows)]
