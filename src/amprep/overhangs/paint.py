"""Find the colours that overhangs are painted in, and make painted faces regions of their own.

Strategy. Overhangs refer to a mesh whose triangles may be pieces of the part's own. A triangle of it is painted if its
centre is on a painted triangle of the part, which a search tree over the centres finds, or inside a marked volume.
"""

from collections.abc import Collection, Iterator

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints
from amprep.geometry.meshes.containment import inside
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.model.build import PlacedPart
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.overhangs.of_part import PartOverhangs
from amprep.overhangs.selection import slopes_of

_FLAT = 1e-4
"""Distance (mm) from the plane of a painted triangle within which a point is on it."""


def split_by_paint(placed: PlacedPart, own: PartOverhangs, colours: Collection[str]) -> PartOverhangs:
    """Divide regions of faces in which some faces are painted otherwise than the rest; edges and tips stay whole.

    Parameters
    ----------
    placed
        The part in the build.
    own
        Its overhangs.
    colours
        Colours as ``#rrggbb``, and names of marked regions, that matter.
    """
    found = own.overhangs
    code = np.zeros(len(found.faces), np.int64)
    for bit, colour in enumerate(sorted(colours)):
        code |= _painted(placed, own.mesh, found.faces, colour).astype(np.int64) << bit
    pieces = np.unique(np.column_stack([found.face_region, code]), axis=0)
    if len(pieces) == len(np.unique(found.face_region)):
        return own
    regions: list[OverhangRegion] = []
    face_region = found.face_region.copy()
    new_number = np.zeros(len(found.regions), np.int32)
    for number, region in enumerate(found.regions):
        new_number[number] = len(regions)
        faces = found.face_region == number
        parts = [faces & (code == each) for each in pieces[pieces[:, 0] == number, 1]]
        if len(parts) < 2:
            face_region[faces] = len(regions)
            regions.append(region)
            continue
        for piece in parts:
            face_region[piece] = len(regions)
            regions.append(_piece(own, region, found.faces[piece]))
    return own._replace(
        overhangs=found._replace(
            face_region=face_region,
            edge_region=new_number[found.edge_region],
            tip_region=new_number[found.tip_region],
            regions=tuple(regions),
        )
    )


def paint_of(placed: PlacedPart, own: PartOverhangs, colours: Collection[str]) -> tuple[frozenset[str], ...]:
    """Return for each region the colours and the names of marked regions that at least half of it has."""
    found = own.overhangs
    names: list[set[str]] = [set() for _ in found.regions]
    for colour in sorted(colours):
        for faces, region in _members(own):
            painted = _painted(placed, own.mesh, faces, colour)
            fraction = np.bincount(region, painted, len(names)) / np.maximum(
                np.bincount(region, None, len(names)), 1
            )
            for number in np.flatnonzero(fraction >= 0.5):
                names[number].add(colour)
    return tuple(frozenset(each) for each in names)


def _members(own: PartOverhangs) -> Iterator[tuple[Int64s, Ints]]:
    """Yield triangles and the region of each: overhanging faces, and triangles at knife edges and at tips."""
    found, corners = own.overhangs, own.mesh.triangles
    yield found.faces.astype(np.int64), found.face_region
    for vertices, number in ((found.edges, found.edge_region), (found.tips[:, None], found.tip_region)):
        for region in np.unique(number):
            held = np.isin(corners, vertices[number == region])
            faces = np.flatnonzero(held.sum(axis=1) >= vertices.shape[1])
            yield faces, np.full(len(faces), region)


def _piece(own: PartOverhangs, region: OverhangRegion, faces: Ints) -> OverhangRegion:
    """Return the region of some faces of a region."""
    corners = own.mesh.vertices[own.mesh.triangles[faces]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double = np.linalg.norm(cross, axis=1)
    return region._replace(
        measure=float(double.sum() / 2.0),
        centre=np.average(corners.mean(axis=1), axis=0, weights=np.maximum(double, 1e-300)),
        angle_deg=float(np.degrees(slopes_of(corners).min())),
        lowest_mm=float(corners[:, :, 2].min()),
    )


def painted_triangles(part: Part, mesh: Mesh, colour: str) -> Bools:
    """Tell which triangles ``(m,)`` of a mesh in part coordinates have a colour, or are in the region of that name."""
    as_drawn = PlacedPart(part.name, part, np.eye(4), part.orientations)
    return _painted(as_drawn, mesh, np.arange(len(mesh.triangles)), colour)


def _painted(placed: PlacedPart, mesh: Mesh, faces: Ints | Int64s, colour: str) -> Bools:
    """Tell which triangles of a mesh of the part are painted in a colour, or are in the region of that name."""
    centres = mesh.vertices[mesh.triangles[faces]].mean(axis=1).reshape(-1, 3)
    painted = np.zeros(len(centres), np.bool_)
    if colour.startswith("#"):
        return painted | _on_triangles(
            centres, placed.mesh.vertices[placed.mesh.triangles[_coloured(placed, colour)]]
        )
    for region in placed.part.regions:
        if region.name != colour:
            continue
        if region.mesh is None:
            if region.triangles is not None:
                own_triangles = placed.mesh.triangles[region.triangles]
                painted |= _on_triangles(centres, placed.mesh.vertices[own_triangles])
            continue
        marked = region.mesh.moved(placed.matrix)
        if region.triangles is None:
            painted |= inside(centres, marked.vertices, marked.triangles)
        else:
            painted |= _on_triangles(centres, marked.vertices[marked.triangles])
    return painted


def _coloured(placed: PlacedPart, colour: str) -> Int64s:
    """Return the triangles of a part that have a colour ``#rrggbb`` at their first corner, or else as the part has."""
    look, value = placed.part.appearance, int(colour[1:], 16)
    whole = int(look.colour[1:7], 16) if look.colour else -1
    if look.triangle_colours is None:
        found = np.full(len(placed.mesh.triangles), whole)
    else:
        own = np.asarray(look.triangle_colours, np.int64).reshape(-1, 3)[:, 0]
        found = np.where(own < 0, whole, own >> 8)
    return np.flatnonzero(found == value)


def _on_triangles(points: Floats, corners: Floats) -> Bools:
    """Tell which points ``(n, 3)`` are on one of the triangles ``(k, 3, 3)``."""
    from scipy.spatial import KDTree

    on = np.zeros(len(points), np.bool_)
    if not len(points) or not len(corners):
        return on
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1) + _FLAT
    near = KDTree(points).query_ball_point(centre, radius)
    for (a, b, c), candidates in zip(corners, near, strict=True):
        found = np.array(candidates, np.int64)
        normal = np.cross(b - a, c - a)
        normal /= max(float(np.linalg.norm(normal)), 1e-300)
        offset = points[found] - a
        held = np.abs(offset @ normal) <= _FLAT
        for start, end in ((a, b), (b, c), (c, a)):
            held &= np.cross(end - start, points[found] - start) @ normal >= -1e-9
        on[found[held]] = True
    return on
