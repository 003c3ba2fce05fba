"""Judge territory: supports stay in the shadow of their part with its margin, and out of the shadows of others."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, Ints
from amprep.checks.packing.shadows import Shadow, shadows_of
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.violation import Violation
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.manifold import accepted
from amprep.geometry.plates.inward import is_wide, shrunk
from amprep.model.build import Build, SupportBody
from amprep.model.control import Stop
from amprep.model.mesh import Mesh

if TYPE_CHECKING:
    from manifold3d import CrossSection

PROMISE = "own territory"

TOLERANCE = 0.05
"""Distance (mm) that is granted at the borders of territories, because circles are polygons and files round."""

_SQUARE = 0.25
"""Side (mm) of the squares of the plan that are decided at once."""

_SEGMENTS = 64
"""Sides of the polygons that stand for circles."""


def check_territory(build: Build, stop: Stop, solids: KnownSolids | None = None) -> list[Violation]:
    """Return the supports that leave the territory of their part; with ``territory = "shared"`` there are none.

    The territory of a part is its shadow grown by the margin, without the shadows of other parts where they are not
    below its own shadow. A support that several parts share may be in the territory of any of them; walls without
    thickness and beams are judged as the solids that stand in for them. `solids` are shared
    with other judges.
    """
    found: list[Violation] = []
    if build.settings.rules.territory != "own" or not build.supports:
        return found
    shadows = shadows_of(build.parts)
    solids = solids or KnownSolids()
    for body in build.supports:
        if stop():
            return found
        found += _judged(body, shadows, build, solids)
    return found


def _judged(
    body: SupportBody, shadows: Sequence[Shadow], build: Build, solids: KnownSolids
) -> list[Violation]:
    from manifold3d import CrossSection, JoinType, OpType

    solid = solids.of(body.mesh)
    if body.surface or not accepted(solid):
        return []
    own = CrossSection.batch_boolean([shadows[part].polygons for part in body.parts], OpType.Add)
    limits = [margin_of(build, part) for part in body.parts]
    grown = [
        shadows[part].polygons.offset(limit + TOLERANCE, JoinType.Round, 2.0, _SEGMENTS)
        for part, limit in zip(body.parts, limits, strict=True)
    ]
    allowed = CrossSection.batch_boolean(grown, OpType.Add)
    others = [each for part, each in enumerate(shadows) if part not in body.parts]
    covered = _uncertain_cover(body.mesh, allowed, others)
    outside = covered - allowed
    found = []
    names = " and ".join(build.parts[part].label for part in body.parts)
    if is_wide(outside, TOLERANCE):
        message = (
            f"leaves the shadow of {names} by more than the margin of {max(limits):g} mm{_where(outside)}"
        )
        found.append(Violation(PROMISE, body.name, message))
    for part, other in enumerate(shadows):
        if part not in body.parts and _boxes_meet(covered, other.polygons):
            inside = (covered ^ other.polygons) - own.offset(TOLERANCE, JoinType.Round, 2.0, _SEGMENTS)
            if is_wide(inside, TOLERANCE):
                message = f"enters the shadow of {other.label}, although it holds {names}{_where(inside)}"
                found.append(Violation(PROMISE, body.name, message))
    return found


def _uncertain_cover(mesh: Mesh, allowed: "CrossSection", others: Sequence[Shadow]) -> "CrossSection":
    """Return what those triangles cover that may leave the allowed region or enter a shadow of others.

    Strategy. The plan is divided into squares. A square is certain if it is in the allowed region and in the box of no
    other shadow; a triangle is certain if all squares that its box meets are. Sums over rectangles tell which boxes
    contain uncertain squares. Few triangles are left, those near borders, and only these are united.
    """
    from manifold3d import CrossSection, FillRule

    plan = mesh.vertices[:, :2]
    low = plan.min(axis=0) - _SQUARE
    square = np.floor((plan - low) / _SQUARE).astype(np.int32)
    uncertain = ~_squares_inside(allowed, low, square.max(axis=0) + 2)
    for other in others:
        if not other.polygons.is_empty():
            box = np.floor((np.asarray(other.polygons.bounds()).reshape(2, 2) - low) / _SQUARE) + ((0,), (1,))
            (x0, y0), (x1, y1) = np.clip(box, 0, uncertain.shape).astype(np.int64)
            uncertain[x0:x1, y0:y1] = True
    corners = plan[mesh.triangles[_meet(square, mesh.triangles, uncertain)]]
    one, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    up = one[:, 0] * second[:, 1] - one[:, 1] * second[:, 0] > 0.0
    return CrossSection(list(corners[up]), FillRule.Positive) if up.any() else CrossSection()


def _meet(square: Ints, triangles: Ints, uncertain: Bools) -> Bools:
    """Tell of which triangles the box meets uncertain squares; `square` has the squares of vertices, ``(n, 2)``."""
    sums = np.zeros(np.add(uncertain.shape, 1), np.int32)
    sums[1:, 1:] = uncertain.cumsum(axis=0).cumsum(axis=1)
    columns = [[square[:, axis][triangles[:, corner]] for corner in range(3)] for axis in (0, 1)]
    (x0, x1), (y0, y1) = (
        (np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c) + 1) for a, b, c in columns
    )
    return np.asarray(sums[x1, y1] - sums[x0, y1] - sums[x1, y0] + sums[x0, y0] > 0)


def _squares_inside(region: "CrossSection", low: Floats, shape: Ints) -> Bools:
    """Tell which squares are certainly in a region, ``(nx, ny)``: those with the middle far inside."""
    core = shrunk(region, 1.5 * _SQUARE)
    if core.is_empty():
        return np.zeros(shape, np.bool_)
    slab = core.extrude(1.0).to_mesh64()
    middle = low + (np.indices(tuple(shape)).reshape(2, -1).T + 0.5) * _SQUARE
    points = np.hstack([middle, np.full((len(middle), 1), 0.5)])
    found = inside(points, np.asarray(slab.vert_properties)[:, :3], np.asarray(slab.tri_verts))
    return found.reshape(shape)


def margin_of(build: Build, part: int) -> float:
    """Return the margin (mm) of a part: its own, for which packing left room, or that of the rules."""
    own = build.parts[part].part.overrides.territory_margin_mm
    return build.settings.rules.territory_margin_mm if own is None else own


def _boxes_meet(one: "CrossSection", other: "CrossSection") -> bool:
    if one.is_empty() or other.is_empty():
        return False
    a, b = np.asarray(one.bounds()), np.asarray(other.bounds())
    return bool((a[:2] <= b[2:]).all() and (b[:2] <= a[2:]).all())


def _where(region: "CrossSection") -> str:
    points = np.concatenate([np.asarray(contour) for contour in region.to_polygons()])
    low, high = points.min(axis=0), points.max(axis=0)
    place = f"from ({low[0]:.2f}, {low[1]:.2f}) to ({high[0]:.2f}, {high[1]:.2f}) mm"
    return f": {region.area():.3g} mm2 of its shadow, {place}"
