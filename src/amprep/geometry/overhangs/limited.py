"""Find the overhangs of a mesh that the part itself does not carry."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int32s, Int64s
from amprep.geometry.overhangs.candidates import Candidates, Modifiers, find_candidates
from amprep.geometry.overhangs.carried.borders import RegionFaces, region_faces
from amprep.geometry.overhangs.carried.points import Carrier, Limits, make_carrier
from amprep.geometry.overhangs.carried.sizes import RegionSize, region_sizes
from amprep.geometry.overhangs.carried.starts import Starts, find_starts
from amprep.geometry.overhangs.carried.stitch import Stitched, stitch
from amprep.geometry.overhangs.carried.stretches import edge_regions
from amprep.geometry.overhangs.carried.subdivide import Pieces, subdivide_at_limits
from amprep.geometry.overhangs.carried.summaries import face_regions, noncritical_regions, tip_regions
from amprep.geometry.overhangs.faces import overhanging_faces
from amprep.geometry.overhangs.regions import (
    OverhangRegion,
    Overhangs,
    components_of_faces,
    numbered_by_first,
)

# Strategy. Faces flatter than the angle form natural regions, whether blocked, enforced or not: how the part carries
# them is geometry. Where a region starts in the air, supports hold the start, and what is printed before the anchors
# that would carry it; a wide level start is held completely, so that it carries what is beside it as the plate does.
# All else is subdivided at the limits.
# Only then blockers take pieces away and enforcers add faces, and what is left is labelled again, since a blocker may
# cut a region in two. Faces that need support as a whole or not at all keep their own triangles, so the mesh grows
# only where a limit divides a face.


_NARROW = 0.01
"""Width (mm) of regions that are no overhangs where nothing carries them and nothing starts in the air."""


class LimitedOverhangs(NamedTuple):
    """Overhangs, and the mesh ``(n, 3)``, ``(m, 3)`` that their indices refer to.

    Points at which stretches of knife edges end are among the vertices, but no triangle has them.
    """

    vertices: Floats
    triangles: Int32s
    overhangs: Overhangs


class _JudgedFaces(NamedTuple):
    """The triangles of a mesh that is subdivided at the limits.

    Attributes
    ----------
    points, stitched
        Points ``(n, 3)`` mm, those of the surface first, and the triangles.
    needed
        ``(k,)`` bool, triangles of natural regions that need support.
    """

    points: Floats
    stitched: Stitched
    needed: Bools


def find_limited_overhangs(
    vertices: Floats,
    triangles: Int32s,
    limits: Limits,
    *,
    noncritical_deg: float = 0.0,
    modifiers: Modifiers | None = None,
) -> LimitedOverhangs:
    """Find the overhangs of a mesh, and which of them the part itself carries.

    A point of an overhang region is carried if a straight line in plan leads over the region to a border that the
    part holds, no longer than a ledge may be; if it is on a line between two such borders, no longer than a bridge
    may be; or if it is under an arch whose diameter is at most that of a bore. Where the part starts in the air, its
    start needs support, and so does what is printed before the part reaches such a border. Where a limit divides a
    face, the mesh is subdivided.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm in build coordinates, ``(m, 3)`` with normals out of the solid.
    limits
        Overhang angle and limits.
    noncritical_deg
        Faces from the overhang angle up to this angle form regions that need no support.
    modifiers
        Triangles and vertices selected by blockers and enforcers.
    """
    found = find_candidates(
        vertices, triangles, limits.angle_deg, modifiers, plate=limits.plate, dip=limits.layer
    )
    surface = found.surface
    starts = find_starts(surface, found.minimum, found.natural, limits.ledge)
    own = region_faces(surface, found.normals, found.natural, limits.plate, starts.wide)
    carrier = make_carrier(own, found.normals, limits, _hanging(found, own, starts))
    judged = _judge_faces(found, carrier, starts)
    label = np.full(len(triangles), -1)
    label[found.faces] = numbered_by_first(components_of_faces(surface, found.faces))
    parent = judged.stitched.parent
    region, needed = label[parent], (judged.needed | found.enforced[parent]) & found.faces[parent]
    corners = judged.points[judged.stitched.triangles]
    regions = _sized_regions(found, carrier, starts, corners, parent, region, needed)
    spared = np.zeros(len(triangles), np.bool_)
    if noncritical_deg > limits.angle_deg:
        spared = overhanging_faces(surface, found.normals, noncritical_deg, limits.plate)
        spared &= ~found.natural & ~found.enforced & ~found.blocked
    regions += noncritical_regions(surface, spared)
    edges = edge_regions(found, starts, limits)
    edge_number = edges.number + len(regions)
    regions += edges.regions
    tip_number, of_tips = tip_regions(found)
    tip_number += len(regions)
    regions += of_tips
    chosen = np.flatnonzero(needed)
    beside = np.flatnonzero(~needed & (region >= 0) & np.isin(region, region[chosen]))
    first = surface.first.astype(np.int32)
    finer, corners_of = _mesh(vertices, triangles, found, judged)
    points = np.concatenate([first, len(finer) + np.arange(len(edges.points), dtype=np.int32)])
    overhangs = Overhangs(
        chosen.astype(np.int32),
        region[chosen].astype(np.int32),
        points[edges.ends].astype(np.int32),
        edge_number.astype(np.int32),
        first[found.tips],
        tip_number.astype(np.int32),
        tuple(regions),
        beside.astype(np.int32),
    )
    if len(edges.points):
        finer = np.concatenate([finer, edges.points])
    return LimitedOverhangs(finer, corners_of, overhangs)


def _hanging(found: Candidates, own: RegionFaces, starts: Starts) -> Bools:
    """Tell which faces are in natural regions that touch a start in the air."""
    touching = starts.touching[found.surface.triangles[own.face]].any(axis=1)
    return np.isin(own.label, own.label[touching])


def _judge_faces(found: Candidates, carrier: Carrier, starts: Starts) -> _JudgedFaces:
    """Subdivide the natural regions at the limits, and tell which triangles need support.

    Supports hold level starts completely, and what touches a start without level faces.
    """
    surface, own = found.surface, carrier.regions
    corners, level, sliver = surface.triangles[own.face], starts.level[own.face], _slivers(carrier)[own.label]
    pieces = subdivide_at_limits(carrier, surface.points, corners, ~(level | sliver))
    at_start = np.zeros(len(pieces.points), np.bool_)
    at_start[: len(surface.points)] = starts.pointed
    pieces = pieces._replace(needed=pieces.needed | at_start[pieces.triangles].any(axis=1))
    mixed = _mixed(pieces, len(own.face))
    needed = level | (sliver & starts.pointed[corners].any(axis=1))
    needed[pieces.face[pieces.needed]] = True
    kept = mixed[pieces.face]
    stitched = stitch(
        surface.triangles, pieces.triangles[kept], own.face[pieces.face[kept]], len(surface.points)
    )
    of_surface = np.zeros(len(surface.triangles), np.bool_)
    of_surface[own.face] = needed
    judged = of_surface[stitched.parent]
    judged[stitched.piece >= 0] = pieces.needed[kept]
    return _JudgedFaces(pieces.points, stitched, judged)


def _slivers(carrier: Carrier) -> Bools:
    """Tell which natural regions no border carries, but are narrower than `_NARROW`: noise of the mesh.

    The width is that of a strip with the same area and perimeter.
    """
    own = carrier.regions
    count = len(carrier.diameters)
    sides = np.roll(own.corners, -1, axis=1) - own.corners
    border = np.where(own.beyond < 0, np.linalg.norm(sides, axis=2), 0.0).sum(axis=1)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    width = (
        2 * np.bincount(own.label, area, count) / np.maximum(np.bincount(own.label, border, count), 1e-300)
    )
    return np.asarray((width <= _NARROW) & ~np.isin(np.arange(count), own.anchor_label))


def _mixed(pieces: Pieces, count: int) -> Bools:
    """Tell which of `count` faces have both pieces that need support and pieces that do not."""
    both = np.zeros((2, count), np.bool_)
    both[pieces.needed.astype(np.int64), pieces.face] = True
    return np.asarray(both.all(axis=0))


def _sized_regions(
    found: Candidates,
    carrier: Carrier,
    starts: Starts,
    corners: Floats,
    parent: Int64s,
    region: Int64s,
    needed: Bools,
) -> list[OverhangRegion]:
    """Return the regions of faces with their kinds and sizes; nothing carries wide starts."""
    count = int(region.max(initial=-1)) + 1
    holds = np.bincount(region[needed], minlength=count) == 0
    position = np.full(len(found.natural), -1)
    position[carrier.regions.face] = np.arange(len(carrier.regions.face))
    chosen = needed | (region >= 0)
    chosen[chosen] &= needed[chosen] | holds[region[chosen]]
    judged = np.flatnonzero(chosen & (position[parent] >= 0) & ~starts.wide[parent])
    sizes = region_sizes(carrier, corners[judged], position[parent[judged]], region[judged], holds)
    sizes |= dict.fromkeys(region[needed & starts.wide[parent]].tolist(), RegionSize("flat", 0.0, 0.0))
    own = np.flatnonzero(chosen)
    in_air = np.zeros(count, np.bool_)
    touching = starts.level | starts.pointed[found.surface.triangles].any(axis=1)
    in_air[region[touching[parent] & (region >= 0)]] = True
    return face_regions(corners[own], region[own], sizes, holds, in_air)


def _mesh(
    vertices: Floats, triangles: Int32s, found: Candidates, judged: _JudgedFaces
) -> tuple[Floats, Int32s]:
    """Return the mesh given with the triangles that were subdivided."""
    if (judged.stitched.piece < 0).all():
        return vertices, triangles
    corners = judged.stitched.triangles
    used = np.unique(corners[corners >= len(found.surface.points)])
    number = np.zeros(len(judged.points), np.int32)
    number[: len(found.surface.points)] = found.surface.first
    number[used] = len(vertices) + np.arange(len(used))
    finer = number[corners]
    uncut = np.bincount(judged.stitched.parent)[judged.stitched.parent] == 1
    finer[uncut] = triangles[judged.stitched.parent[uncut]]
    return np.concatenate([vertices, judged.points[used]]), finer
