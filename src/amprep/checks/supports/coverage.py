"""The promise of coverage: whatever needs support is within reach of a contact, or listed with its reason."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.checks.violation import Violation
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.sampling import OverhangSamples, sample_overhangs, sample_segments
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.model.build import Build, BuildSettings, PlacedPart, SupportBody, Unsupported
from amprep.model.mesh import Mesh
from amprep.overhangs.of_part import overhangs_of
from amprep.overhangs.unsupported import list_bare, region_name

PROMISE = "coverage"

_NUDGE = 0.01
"""mm; a contact is looked for this far below a face, and a face this far above a support."""

_MOST_CELLS = 4_000_000

_JUDGE_ANGLE_DEG = 0.02
"""What the judge grants at the threshold, so that rounding in a file breaks no promise."""

Reasons = Callable[[int, Floats], Sequence[str]]


class _Covered(NamedTuple):
    """A part's samples, its regions, and which samples are within reach of a contact."""

    samples: OverhangSamples
    regions: tuple[OverhangRegion, ...]
    covered: Bools


def find_unsupported(
    parts: Sequence[PlacedPart], bodies: Sequence[SupportBody], settings: BuildSettings, reason_of: Reasons
) -> tuple[Unsupported, ...]:
    """List what needs support and has no contact within reach, by part, region and reason.

    Parameters
    ----------
    reason_of
        Called with a part's index and points ``(n, 3)``; says for each why nothing holds it.
    """
    found: list[Unsupported] = []
    for part, each in enumerate(_coverage(parts, bodies, settings, settings.reach)):
        reasons = partial(reason_of, part)
        found += list_bare(
            part, parts[part].label, each.samples, each.regions, each.covered, settings, reasons
        )
    return tuple(found)


def check_coverage(build: Build) -> list[Violation]:
    """Judge a finished build from its meshes alone: every sample of what needs support is held or listed."""
    if not build.settings.supported:
        return []
    reach = build.settings.reach + _NUDGE
    found = []
    for part, each in enumerate(
        _coverage(build.parts, build.supports, build.settings, reach, _JUDGE_ANGLE_DEG)
    ):
        covered = each.covered.copy()
        for listed in build.unsupported:
            if listed.part == part and not covered.all():
                bare = np.flatnonzero(~covered)
                near = _nearest(listed.points, each.samples.points[bare], listed.radius + _NUDGE)
                covered[bare] = near
        for region in np.unique(each.samples.region[~covered]):
            bare = ~covered & (each.samples.region == region)
            x, y, z = each.samples.points[bare][0]
            where = f"{region_name(int(region), build.parts[part].label)} ({each.regions[region].kind})"
            message = (
                f"{where} has {bare.sum()} sample points over {build.settings.reach:g} mm from any contact "
                f"and is not listed, first at ({x:.2f}, {y:.2f}, {z:.2f}) mm"
            )
            found.append(Violation(PROMISE, build.parts[part].label, message))
    return found


def _coverage(
    parts: Sequence[PlacedPart],
    bodies: Sequence[SupportBody],
    settings: BuildSettings,
    reach: float,
    grant_deg: float = 0.0,
) -> list[_Covered]:
    """Sample every part's needs, and see which samples have a contact on the same part within reach."""
    covered = []
    for placed in parts:
        needs = overhangs_of(placed, settings.rules, add_angle_deg=-grant_deg)
        own = placed.part.overrides.overhang_angle_deg
        angle = min(settings.rules.overhang_angle_deg if own is None else own, 85.0)
        spacing = settings.reach / 3 * min(1.0, float(np.sqrt(2) * np.cos(np.radians(angle))))
        samples = sample_overhangs(needs.mesh.vertices, needs.mesh.triangles, needs.overhangs, spacing)
        held = _held(samples.points, placed.mesh, bodies, spacing, reach)
        covered.append(_Covered(samples, needs.overhangs.regions, held))
    return covered


def _held(points: Floats, mesh: Mesh, bodies: Sequence[SupportBody], spacing: float, reach: float) -> Bools:
    """Tell which points of a part have a contact of a support with that part within reach."""
    near = [body for body in bodies if len(points) and _touch(body.mesh.bounds, mesh.bounds, reach)]
    held = _touched(points, near)
    contacts, bare = points[held], np.flatnonzero(~held)
    held[bare] = _nearest(contacts, points[bare], reach)
    if not held.all():
        bare = np.flatnonzero(~held)
        held[bare] = _nearest(_embedded(points[bare], mesh, near, spacing, reach), points[bare], reach)
    return held


def _touch(one: tuple[Floats, Floats], other: tuple[Floats, Floats], margin: float) -> bool:
    return bool((one[0] <= other[1] + margin).all() and (other[0] <= one[1] + margin).all())


def _touched(points: Floats, bodies: Sequence[SupportBody]) -> Bools:
    """Tell which points rest on the plate or have the inside of a solid support right below them."""
    touched = np.asarray(points[:, 2] <= CONTACT_TOLERANCE)
    lower = points - (0.0, 0.0, _NUDGE)
    for body in bodies:
        if not body.surface:
            near = np.flatnonzero(~touched & _between(lower, *body.mesh.bounds))
            touched[near] = inside(lower[near], body.mesh.vertices, body.mesh.triangles)
    return touched


def _embedded(
    points: Floats, mesh: Mesh, bodies: Sequence[SupportBody], spacing: float, reach: float
) -> Floats:
    """Return points on the edges of supports that lie in or on the part, about `reach` from `points`."""
    found = [np.empty((0, 3))]
    for body in bodies:
        lo, hi = body.mesh.bounds
        near = points[_between(points, lo - reach, hi + reach)]
        if len(near):
            low = np.maximum(near.min(axis=0) - reach, mesh.bounds[0] - _NUDGE)
            high = np.minimum(near.max(axis=0) + reach, mesh.bounds[1] + _NUDGE)
            on_edges = _edge_points(body, low, high, spacing)
            on_edges = on_edges[_about(near, on_edges, reach)]
            upper = np.add(on_edges, (0.0, 0.0, _NUDGE))
            found.append(on_edges[inside(upper, mesh.vertices, mesh.triangles)])
    return np.concatenate(found)


def _about(targets: Floats, points: Floats, reach: float) -> Bools:
    """Tell which points are in a cell of a coarse grid with one of `targets` in it or beside it."""
    from scipy.ndimage import binary_dilation

    corner = targets.min(axis=0) - reach
    extent = targets.max(axis=0) + reach - corner
    cell = max(reach, float(np.cbrt(np.prod(extent) / _MOST_CELLS)))
    shape = tuple((extent // cell).astype(int) + 1)
    taken = np.zeros(shape, np.bool_)
    taken[tuple(((targets - corner) // cell).astype(int).T)] = True
    taken = binary_dilation(taken, np.ones((3, 3, 3), np.bool_))
    within = np.flatnonzero(_between(points, corner, corner + extent))
    about = np.zeros(len(points), np.bool_)
    about[within] = taken[tuple(((points[within] - corner) // cell).astype(int).T)]
    return about


def _edge_points(body: SupportBody, lo: Floats, hi: Floats, spacing: float) -> Floats:
    """Return points along the edges that can meet the box from `lo` to `hi`.

    A closed surface has every edge in both directions and only one of them is taken.
    """
    triangles = body.mesh.triangles[_boxes_meet(body.mesh, lo, hi)]
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    once = np.ones(len(start), np.bool_) if body.surface else start < end
    vertices = body.mesh.vertices
    points, _ = sample_segments(vertices[start[once]], vertices[end[once]], spacing)
    return points[_between(points, lo, hi)]


def _boxes_meet(mesh: Mesh, lo: Floats, hi: Floats) -> Bools:
    """Tell which triangles' bounding boxes meet the box from `lo` to `hi`."""
    meets = np.ones(len(mesh.triangles), np.bool_)
    for axis in range(3):
        a, b, c = mesh.vertices[:, axis][mesh.triangles.T]
        meets &= (np.maximum(np.maximum(a, b), c) >= lo[axis]) & (np.minimum(np.minimum(a, b), c) <= hi[axis])
    return meets


def _between(points: Floats, lo: Floats, hi: Floats) -> Bools:
    within = np.ones(len(points), np.bool_)
    for axis in range(3):
        within &= (points[:, axis] >= lo[axis]) & (points[:, axis] <= hi[axis])
    return within


def _nearest(targets: Floats, points: Floats, reach: float) -> Bools:
    """Tell which `points` have one of `targets` within `reach`."""
    from scipy.spatial import KDTree

    if not len(targets) or not len(points):
        return np.zeros(len(points), np.bool_)
    distance, _ = KDTree(targets).query(points, distance_upper_bound=reach)
    return np.asarray(np.isfinite(distance))
