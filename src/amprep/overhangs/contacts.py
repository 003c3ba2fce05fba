"""Find the points of overhangs that a support touches, or that are within reach of such a contact."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Int64s
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.sampling import sample_segments
from amprep.model.build import BuildSettings, PlacedPart, SupportBody
from amprep.model.mesh import Mesh

NUDGE = 0.01
"""Distance (mm) below a face at which a support must be, and above a support at which a part must be."""

_MOST_SAMPLES = 2_000_000
"""Largest number of sample points on the faces of a part."""

_MOST_CELLS = 4_000_000
"""Largest number of cells of the grid that preselects points."""


def sample_spacing(placed: PlacedPart, bodies: Sequence[SupportBody], settings: BuildSettings) -> float:
    """Return the spacing (mm) of sample points at which no point of an overhang is farther than reach / 3 from one.

    The least reach of the bodies counts, so that planner and judge sample the same points. It is larger where there
    would be more than `_MOST_SAMPLES` of them.
    """
    own = placed.part.overrides.overhang_angle_deg
    angle = min(settings.rules.overhang_angle_deg if own is None else own, 85.0)
    reach = min([settings.reach, *(settings.reach_of(body) for body in bodies)])
    spacing = reach / 3 * min(1.0, float(np.sqrt(2) * np.cos(np.radians(angle))))
    return max(spacing, float(np.sqrt(_downward_area(placed.mesh) / _MOST_SAMPLES)))


def _downward_area(mesh: Mesh) -> float:
    """Return the area (mm2) in plan of the faces of a mesh that face downwards."""
    corners = mesh.vertices[mesh.triangles]
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    upward = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return float(-upward[upward < 0.0].sum() / 2.0)


def find_held(
    points: Floats,
    mesh: Mesh,
    bodies: Sequence[SupportBody],
    settings: BuildSettings,
    spacing: float,
    border: float = 0.0,
) -> Bools:
    """Tell which sample points of a part have a contact with that part within the reach of the body of the contact.

    The plate has the reach of the build. A contact is a sample point on the plate or directly above a solid support.
    Where there is none, points on the edges of supports in or on the part are contacts, too: of narrow connectors, and
    of walls without thickness.

    Parameters
    ----------
    points
        ``(n, 3)`` mm, points on the overhangs of one part.
    mesh
        The part in build coordinates.
    bodies
        All supports of the build.
    settings
        Settings of the build, with the reach of bodies that state none.
    spacing
        Distance of the sample points, mm.
    border
        Distance (mm) that is granted on every reach.
    """
    held = np.zeros(len(points), np.bool_)
    reaches = {settings.reach, *(settings.reach_of(body) for body in bodies)}
    for reach in sorted(reaches, reverse=True):
        own = [body for body in bodies if settings.reach_of(body) == reach]
        left = np.flatnonzero(~held)
        on_plate = (
            points[:, 2] <= CONTACT_TOLERANCE if reach == settings.reach else np.zeros(len(points), np.bool_)
        )
        held[left] = _held_within(points, left, mesh, own, on_plate, spacing, reach + border)
    return held


def _held_within(
    points: Floats,
    asked: Int64s,
    mesh: Mesh,
    bodies: Sequence[SupportBody],
    on_plate: Bools,
    spacing: float,
    reach: float,
) -> Bools:
    """Tell which of the points `asked` have a contact of bodies with the same reach within it."""
    near = [body for body in bodies if len(asked) and _boxes_meet(body.mesh.bounds, mesh.bounds, reach)]
    contacts = points[_touched(points, on_plate, near)]
    held = is_near(contacts, points[asked], reach)
    if not held.all():
        left = asked[~held]
        held[~held] = is_near(_embedded(points[left], mesh, near, spacing, reach), points[left], reach)
    return held


def _boxes_meet(one: tuple[Floats, Floats], other: tuple[Floats, Floats], margin: float) -> bool:
    """Tell whether two boxes come within `margin` mm of one another."""
    return bool((one[0] <= other[1] + margin).all() and (other[0] <= one[1] + margin).all())


def _touched(points: Floats, on_plate: Bools, bodies: Sequence[SupportBody]) -> Bools:
    """Tell which points are on the plate or directly above the interior of a solid support."""
    touched = on_plate.copy()
    lower = points - (0.0, 0.0, NUDGE)
    for body in bodies:
        if not body.surface:
            near = np.flatnonzero(~touched & _in_box(lower, *body.mesh.bounds))
            touched[near] = inside(lower[near], body.mesh.vertices, body.mesh.triangles)
    return touched


def _embedded(
    points: Floats, mesh: Mesh, bodies: Sequence[SupportBody], spacing: float, reach: float
) -> Floats:
    """Return points on the edges of supports, in or on the part, within about `reach` of `points`."""
    found = [np.empty((0, 3))]
    for body in bodies:
        lo, hi = body.mesh.bounds
        near = points[_in_box(points, lo - reach, hi + reach)]
        if len(near):
            low = np.maximum(near.min(axis=0) - reach, mesh.bounds[0] - NUDGE)
            high = np.minimum(near.max(axis=0) + reach, mesh.bounds[1] + NUDGE)
            on_edges = _edge_points(body, low, high, spacing)
            on_edges = on_edges[_about(near, on_edges, reach)]
            upper = np.add(on_edges, (0.0, 0.0, NUDGE))
            found.append(on_edges[inside(upper, mesh.vertices, mesh.triangles)])
    return np.concatenate(found)


def _about(targets: Floats, points: Floats, reach: float) -> Bools:
    """Tell which points are in a cell of a coarse grid that contains one of `targets` or is beside such a cell."""
    from scipy.ndimage import binary_dilation

    corner = targets.min(axis=0) - reach
    extent = targets.max(axis=0) + reach - corner
    cell = max(reach, float(np.cbrt(np.prod(extent) / _MOST_CELLS)))
    shape = tuple((extent // cell).astype(int) + 1)
    taken = np.zeros(shape, np.bool_)
    taken[tuple(((targets - corner) // cell).astype(int).T)] = True
    taken = binary_dilation(taken, np.ones((3, 3, 3), np.bool_))
    within = np.flatnonzero(_in_box(points, corner, corner + extent))
    about = np.zeros(len(points), np.bool_)
    about[within] = taken[tuple(((points[within] - corner) // cell).astype(int).T)]
    return about


def _edge_points(body: SupportBody, lo: Floats, hi: Floats, spacing: float) -> Floats:
    """Return points on the edges of a support, in the box from `lo` to `hi`.

    A closed surface has each edge in both directions; one of them is sampled.
    """
    triangles = body.mesh.triangles[_triangles_near(body.mesh, lo, hi)]
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    once = np.ones(len(start), np.bool_) if body.surface else start < end
    vertices = body.mesh.vertices
    points, _ = sample_segments(vertices[start[once]], vertices[end[once]], spacing)
    return points[_in_box(points, lo, hi)]


def _triangles_near(mesh: Mesh, lo: Floats, hi: Floats) -> Bools:
    """Tell which triangles have a bounding box that meets the box from `lo` to `hi`."""
    meets = np.ones(len(mesh.triangles), np.bool_)
    for axis in range(3):
        a, b, c = mesh.vertices[:, axis][mesh.triangles.T]
        meets &= (np.maximum(np.maximum(a, b), c) >= lo[axis]) & (np.minimum(np.minimum(a, b), c) <= hi[axis])
    return meets


def _in_box(points: Floats, lo: Floats, hi: Floats) -> Bools:
    """Tell which points are in the box from `lo` to `hi`."""
    within = np.ones(len(points), np.bool_)
    for axis in range(3):
        within &= (points[:, axis] >= lo[axis]) & (points[:, axis] <= hi[axis])
    return within


def is_near(targets: Floats, points: Floats, reach: float) -> Bools:
    """Tell which `points` ``(n, 3)`` have one of `targets` ``(k, 3)`` within `reach` mm."""
    from scipy.spatial import KDTree

    if not len(targets) or not len(points):
        return np.zeros(len(points), np.bool_)
    distance, _ = KDTree(targets).query(points, distance_upper_bound=reach)
    return np.asarray(np.isfinite(distance))
