"""Clip the beams of a support group at parts and drop floating components; add a mesh for readers without beams."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, Ints, MeshArrays
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

if TYPE_CHECKING:
    from manifold3d import Manifold

_FACTOR_26, _FACTOR_200 = 1.15, 1.06
"""Factors on the radius of a ball that is tested at 26 or 200 points: it may extend farther between two points."""

_STEP = 0.25
"""Distance between the balls at which beams are tested, in radii."""

_DIRECTIONS_200 = sphere(200)

_SLIVER = 1e-3
"""Volume (mm3) below which a floating piece of a connector is dropped without a message."""

_HORIZONTAL = DIRECTIONS[np.abs(DIRECTIONS[:, 2]) < 1e-9]


def clip_beams(
    beams: Beams,
    parts: Sequence[PlacedPart],
    held: tuple[int, ...],
    space: BuildVolume,
    *,
    overlap: float,
    gap: float,
) -> Beams:
    """Shorten beams that enter parts, come too near to their walls, or leave the build volume.

    Of each beam the longest clear stretch is kept; a beam without one is dropped. As for connectors, depth is measured
    vertically.

    Parameters
    ----------
    beams
        Beams of one group.
    parts
        Placed parts of the build.
    held
        Parts that may be entered by the overlap; other parts must not be entered.
    space
        Build volume with forbidden zones.
    overlap
        Permitted depth, mm.
    gap
        XY distance, mm.
    """
    if not len(beams.struts):
        return beams
    places = sample(beams.nodes, beams.struts.astype(np.int64), beams.radii, _STEP)
    blocked = _out_of_bounds(places, space)
    for index, placed in enumerate(parts):
        if not placed.part.is_solid:
            continue
        mesh, depth = placed.mesh, overlap if index in held else CONTACT_TOLERANCE
        arrays = mesh.arrays
        blocked |= balls_too_deep(places.centres, _FACTOR_26 * places.radii, *arrays, depth, DIRECTIONS)
        # edges and thin walls of a part may fit between 26 points
        blocked |= balls_too_deep(places.centres, _FACTOR_200 * places.radii, *arrays, depth, _DIRECTIONS_200)
        if gap > 0.0:
            blocked |= balls_too_deep(places.centres, places.radii + gap, *arrays, depth + gap, _HORIZONTAL)
    return _clear_stretches(beams, places.strut, places.fraction, blocked)


def _out_of_bounds(places: BeamSamples, space: BuildVolume) -> Bools:
    """Tell which balls enter a forbidden zone or leave a cylindrical build volume; readers clip beams at a box."""
    centres, radii = places.centres, places.radii
    found = np.zeros(len(centres), np.bool_)
    if space.shape == "cylinder":
        middle = space.size[0] / 2
        found |= np.hypot(*(centres[:, :2] - middle).T) + radii > middle
    for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True):
        away = np.maximum(np.maximum(lo - centres, centres - hi), 0.0)
        found |= np.linalg.norm(away, axis=1) < radii
    return found


def _clear_stretches(beams: Beams, strut: Ints, fraction: Floats, blocked: Bools) -> Beams:
    """Return each beam from the first to the last ball of its longest run of clear balls."""
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
        begin, end = fraction[first + run[0]], fraction[first + run[1]]
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
    """Return the first and last index of the longest run of at least two, or None."""
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
    """Return the beams and solids that are connected to the plate; None when solids of the whole body would be lost.

    Parameters
    ----------
    beams
        Clipped beams of one group.
    solids
        Connectors and bases of the group.
    whole
        The same support with struts as solids.
    coarse
        Mesh that replaces `whole` in the file, for readers without beams; None to keep `whole`.
    boxes
        Least and greatest corners ``(k, 3)`` mm of the boxes in which feet on parts end.
    space
        Build volume, which clips the beams.
    """
    points, triangles = _arrays(solids)
    struts = beams.struts.astype(np.int64)

    def rests(vertices: Floats) -> Bools:
        found = vertices[:, 2] <= CONTACT_TOLERANCE
        for low, high in zip(*boxes, strict=True):
            found |= ((vertices >= low) & (vertices <= high)).all(axis=1)
        return np.asarray(found)

    grounded = find_grounded(beams.nodes, struts, beams.radii, points, triangles, rests)
    if not grounded.struts.any() or _loses(grounded, points, triangles, whole):
        return None
    kept = struts[grounded.struts]
    used, local = np.unique(kept, return_inverse=True)
    return Lattice(
        np.round(beams.nodes[used], 6),
        local.reshape(-1, 2).astype(np.int32),
        np.round(beams.radii[grounded.struts], 6),
        Mesh(*drop_unused_vertices(points, triangles[grounded.triangles])),
        whole if coarse is None else coarse,
        np.array([np.zeros(3), space.size]),
    )


def _loses(grounded: GroundedBeams, points: Floats, triangles: Int64s, whole: Mesh) -> bool:
    """Tell whether solids float beside beams that are part of the whole body, where struts are solids."""
    floating = triangles[~grounded.triangles]
    if not len(floating):
        return False
    lost = as_manifold(*drop_unused_vertices(points, floating))
    return any(
        piece.volume() > _SLIVER
        and bool(inside(_middles(piece), whole.vertices, whole.triangles.astype(np.int64)).any())
        for piece in lost.decompose()
    )


def _middles(piece: "Manifold") -> Floats:
    """Return points slightly inside the faces of a solid."""
    mesh = piece.to_mesh64()
    corners = np.array(mesh.vert_properties[:, :3], np.float64)[np.array(mesh.tri_verts, np.int64)]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    return np.asarray(corners.mean(axis=1) - CONTACT_TOLERANCE * normal)


def _arrays(mesh: Mesh | None) -> MeshArrays:
    if mesh is None:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return mesh.arrays


def beams_of_group(cells: Cells, group: int) -> Beams:
    """Return the beams of one group with the nodes that they use."""
    beams = cells.beams or Beams(
        np.empty((0, 3)), np.empty((0, 2), np.int32), np.empty((0, 2)), np.empty(0, np.int32)
    )
    mine = np.asarray(beams.group) == group
    used, local = np.unique(beams.struts[mine], return_inverse=True)
    struts = local.reshape(-1, 2).astype(np.int32)
    return Beams(beams.nodes[used], struts, beams.radii[mine], beams.group[mine])


def whole_prisms(request: CellRequest) -> Cells:
    """Return a whole prism for every edge, as a coarse mesh of a lattice with very many beams."""
    from manifold3d import Manifold

    count = len(request.edges)
    points, triangles = arrays_of(Manifold.cube([1.0, 1.0, 1.0]))
    voxel = Template("prism", Mesh(points, triangles))
    return Cells((voxel,), np.zeros(count, np.int32), np.arange(count, dtype=np.int32), request.matrices)
