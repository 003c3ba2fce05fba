"""Beams of one support group: kept out of parts, pruned to what stands, with a mesh for readers that know none."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import drop_unused_vertices
from amprep.geometry.supports.beams import (
    DIRECTIONS,
    BeamSamples,
    GroundedBeams,
    balls_too_deep,
    find_grounded,
    sample,
    sphere,
)
from amprep.model import (
    CONTACT_TOLERANCE,
    Beams,
    BuildVolume,
    CellRequest,
    Cells,
    Lattice,
    Mesh,
    PlacedPart,
    Template,
)

_WIDER = 1.15
"""Points are tried this much farther out than a beam reaches: it may bulge between two of them."""

_ROUND = 1.06
"""The same for many points."""

_PLACES = 0.25
"""Radii between two balls at which beams are tried."""

_FINE = sphere(200)

_SLIVER = 1e-3
"""mm3; a hanging crumb of a connector smaller than that is left out without a word."""

_SIDEWAYS = DIRECTIONS[np.abs(DIRECTIONS[:, 2]) < 1e-9]


def clip_beams(
    beams: Beams,
    parts: Sequence[PlacedPart],
    held: tuple[int, ...],
    space: BuildVolume,
    *,
    overlap: float,
    gap: float,
) -> Beams:
    """Shorten beams that reach into parts, too near to their walls, or out of bounds; drop those that vanish.

    As for connectors, depth is measured upwards. Of each beam the longest clear stretch stays; beams of one
    group are given.

    Parameters
    ----------
    held
        Parts that may be entered by `overlap` mm; the others not at all.
    gap
        mm sideways.
    """
    if not len(beams.struts):
        return beams
    places = sample(beams.nodes, beams.struts.astype(np.int64), beams.radii, _PLACES)
    blocked = _out_of_bounds(places, space)
    for index, placed in enumerate(parts):
        if not placed.part.is_solid:
            continue
        mesh, depth = placed.mesh, overlap if index in held else CONTACT_TOLERANCE
        arrays = mesh.arrays
        blocked |= balls_too_deep(places.centres, _WIDER * places.radii, *arrays, depth, DIRECTIONS)
        # edges and fins of a part may come between those few points
        blocked |= balls_too_deep(places.centres, _ROUND * places.radii, *arrays, depth, _FINE)
        if gap > 0.0:
            blocked |= balls_too_deep(places.centres, places.radii + gap, *arrays, depth + gap, _SIDEWAYS)
    return _clear_stretches(beams, places.strut, places.share, blocked)


def _out_of_bounds(places: BeamSamples, space: BuildVolume) -> Bools:
    """Tell which balls reach into a forbidden zone or out of a round build volume; a box cuts them off."""
    centres, radii = places.centres, places.radii
    found = np.zeros(len(centres), np.bool_)
    if space.shape == "cylinder":
        middle = space.size[0] / 2
        found |= np.hypot(*(centres[:, :2] - middle).T) + radii > middle
    for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True):
        away = np.maximum(np.maximum(lo - centres, centres - hi), 0.0)
        found |= np.linalg.norm(away, axis=1) < radii
    return found


def _clear_stretches(beams: Beams, strut: np.ndarray, share: Floats, blocked: Bools) -> Beams:
    """Return beams from the first to the last place of their longest run of clear places."""
    cut = np.unique(strut[blocked])
    whole = np.ones(len(beams.struts), np.bool_)
    whole[cut] = False
    nodes, struts, radii = [beams.nodes], [beams.struts[whole]], [beams.radii[whole]]
    group = [beams.group[whole]]
    count = len(beams.nodes)
    for each in cut.tolist():
        first, last = np.searchsorted(strut, (each, each + 1))
        run = _longest_run(~blocked[first:last])
        if run is None:
            continue
        begin, end = share[first + run[0]], share[first + run[1]]
        start, tip = beams.nodes[beams.struts[each]]
        ends = np.array([begin, end])[:, None]
        added = np.array([count, count + 1])
        keeps = np.array([begin == 0.0, end == 1.0])
        nodes.append(start + ends * (tip - start))
        struts.append(np.where(keeps, beams.struts[each], added)[None])
        radii.append((beams.radii[each, 0] + ends * (beams.radii[each, 1] - beams.radii[each, 0])).T)
        group.append(beams.group[each : each + 1])
        count += 2
    return Beams(
        np.concatenate(nodes),
        np.concatenate(struts).astype(np.int32),
        np.concatenate(radii),
        np.concatenate(group),
    )


def _longest_run(clear: Bools) -> tuple[int, int] | None:
    """Return the first and last place of the longest run of two or more, or None."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], clear, [False]]).astype(np.int8)))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return None
    first, behind = runs[int((runs[:, 1] - runs[:, 0]).argmax())].tolist()
    return (first, behind - 1) if behind - first > 1 else None


def lattice_of(
    beams: Beams,
    solids: Mesh | None,
    whole: Mesh,
    coarse: Mesh | None,
    boxes: tuple[Floats, Floats],
    space: BuildVolume,
) -> Lattice | None:
    """Return what stands of beams and of the solids that they carry; None when they do not carry enough.

    Parameters
    ----------
    whole
        The same body as a solid: what it has of the solids must not get lost.
    coarse
        Stands in for `whole` in the file, if given.
    boxes
        Least and greatest corners of the boxes in which feet on parts end.
    """
    points, triangles = _arrays(solids)
    struts = beams.struts.astype(np.int64)

    def rests(vertices: Floats) -> Bools:
        found = vertices[:, 2] <= CONTACT_TOLERANCE
        for low, high in zip(*boxes, strict=True):
            found |= ((vertices >= low) & (vertices <= high)).all(axis=1)
        return np.asarray(found)

    stands = find_grounded(beams.nodes, struts, beams.radii, points, triangles, rests)
    if not stands.struts.any() or _loses(stands, points, triangles, whole):
        return None
    kept = struts[stands.struts]
    used, local = np.unique(kept, return_inverse=True)
    return Lattice(
        np.round(beams.nodes[used], 6),
        local.reshape(-1, 2).astype(np.int32),
        np.round(beams.radii[stands.struts], 6),
        Mesh(*drop_unused_vertices(points, triangles[stands.triangles])),
        whole if coarse is None else coarse,
        np.array([np.zeros(3), space.size]),
    )


def _loses(stands: GroundedBeams, points: Floats, triangles: np.ndarray, whole: Mesh) -> bool:
    """Tell whether solids hang on nothing that the whole body has: as one solid, something carries them there."""
    hanging = triangles[~stands.triangles]
    if not len(hanging):
        return False
    lost = as_manifold(*drop_unused_vertices(points, hanging))
    return any(
        piece.volume() > _SLIVER
        and bool(inside(_middles(piece), whole.vertices, whole.triangles.astype(np.int64)).any())
        for piece in lost.decompose()
    )


def _middles(piece: object) -> Floats:
    """Return points a little inside the faces of a solid."""
    mesh = piece.to_mesh64()  # type: ignore[attr-defined]
    corners = np.array(mesh.vert_properties[:, :3], np.float64)[np.array(mesh.tri_verts, np.int64)]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    return np.asarray(corners.mean(axis=1) - CONTACT_TOLERANCE * normal)


def _arrays(mesh: Mesh | None) -> tuple[Floats, np.ndarray]:
    if mesh is None:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return mesh.arrays


def of_group(cells: Cells, group: int) -> Beams:
    """Return the beams of one group, with the nodes they use."""
    beams = cells.beams or Beams(
        np.empty((0, 3)), np.empty((0, 2), np.int32), np.empty((0, 2)), np.empty(0, np.int32)
    )
    mine = np.asarray(beams.group) == group
    used, local = np.unique(beams.struts[mine], return_inverse=True)
    struts = local.reshape(-1, 2).astype(np.int32)
    return Beams(beams.nodes[used], struts, beams.radii[mine], beams.group[mine])


def prisms(request: CellRequest) -> Cells:
    """Return every edge as its whole prism: what stands in for a lattice of very many beams."""
    from manifold3d import Manifold

    count = len(request.edges)
    points, triangles = arrays_of(Manifold.cube([1.0, 1.0, 1.0]))
    voxel = Template("prism", Mesh(points, triangles))
    return Cells((voxel,), np.zeros(count, np.int32), np.arange(count, dtype=np.int32), request.matrices)
