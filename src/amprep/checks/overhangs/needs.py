"""Tell which sample points of overhangs need a contact: those that the part itself does not carry.

With the rules of the thesis all of them do. With limits the judge flags only what is certainly not carried: it grants
the planner `GRANT_MM` on every limit. A region in which the part starts in the air needs contacts everywhere.
"""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.overhangs.along_edges import carried_along
from amprep.checks.overhangs.borders import region_edges, regions_of
from amprep.checks.overhangs.lines import Reaches, carried
from amprep.checks.overhangs.samples import ENFORCED, JudgedOverhangs
from amprep.checks.overhangs.search import ROUNDING
from amprep.checks.overhangs.starts import starts_in_air
from amprep.checks.overhangs.surface import MergedMesh, labels
from amprep.model.supports.rules import OverhangRules

GRANT_MM = 0.08
"""Length (mm) that is granted on ledges, bridges and bores."""

_GRANT_PART = 0.01
"""Fraction of a span that is granted because lines through a point have a finite number of directions."""

_NOISE = 0.01
"""Width (mm) up to which a region that does not start in the air is noise of the mesh, and no overhang."""

_INWARDS = 0.02
"""Distance (mm) by which samples are moved into their faces, so that no sample is on a border."""


def are_needed(found: JudgedOverhangs, rules: OverhangRules, rows: Int64s, *, strict: bool = False) -> Bools:
    """Tell which of the samples `rows` certainly need a contact, ``(n,)``.

    Parameters
    ----------
    found
        The overhangs of a part.
    rules
        Limits.
    rows
        Indices of samples.
    strict
        Whether the tolerances count against the part instead, and only few lines are tried: then the other samples are
        certainly carried.
    """
    if not rules.has_limits or not len(rows):
        return np.ones(len(rows), np.bool_)
    sign = -1.0 if strict else 1.0
    reaches = _reaches(rules, found.angle, sign)
    plate = rules.plate_mm + ROUNDING
    starts = starts_in_air(found.surface, plate, rules.layer_mm + sign * ROUNDING)
    samples = found.samples.chosen(rows)
    needed = samples.points[:, 2] > plate
    on_faces = np.flatnonzero(needed & (samples.kind == 0) & (samples.owner != ENFORCED))
    needed[on_faces] = ~_carried_faces(
        found, samples.points[on_faces], samples.owner[on_faces], starts, reaches, plate, not strict
    )
    on_edges = np.flatnonzero(needed & (samples.kind == 1))
    needed[on_edges] = ~_carried_edges(
        found, samples.points[on_edges], samples.owner[on_edges], starts, reaches, plate
    )
    return needed


def _reaches(rules: OverhangRules, angle: float, sign: float) -> Reaches:
    def granted(limit: float) -> float:
        return max(limit * (1.0 + sign * _GRANT_PART) + sign * GRANT_MM, 0.0)

    ledge, bridge, bore = (granted(limit) for limit in (rules.ledge_mm, rules.bridge_mm, rules.bore_mm))
    return Reaches(ledge, bridge, bore, angle, 0.5 - 0.05 * sign)


def _carried_faces(
    found: JudgedOverhangs,
    points: Floats,
    owner: Int64s,
    starts: Bools,
    reaches: Reaches,
    plate: float,
    thorough: bool,
) -> Bools:
    """Tell which samples on faces the part itself carries."""
    surface = found.surface
    faces = found.overhangs.faces.astype(np.int64)
    if not len(points):
        return np.zeros(0, np.bool_)
    region = regions_of(surface, faces)
    edges = region_edges(surface, faces, region, reaches.angle, plate)
    in_air = np.zeros(int(region.max()) + 1, np.bool_)
    in_air[region[starts[surface.triangles[faces]].any(axis=1)]] = True
    is_carried = (_widths(surface, faces, region) <= _NOISE)[region[owner]] & ~in_air[region[owner]]
    rows = np.flatnonzero(~in_air[region[owner]] & ~is_carried)
    inner = _inwards(surface, points[rows], faces[owner[rows]])
    is_carried[rows] = carried(inner, region[owner[rows]], edges, reaches, thorough=thorough)
    return is_carried


def _widths(surface: MergedMesh, faces: Int64s, region: Int64s) -> Floats:
    """Return the width (mm) of each region: that of a strip with the same area and perimeter."""
    edge, first, count = np.unique(surface.edge[faces], return_index=True, return_counts=True)
    length = np.linalg.norm(np.diff(surface.points[surface.ends[edge]], axis=1)[:, 0], axis=1)
    perimeter = np.bincount(region[first // 3], weights=np.where(count == 1, length, 0.0))
    return np.asarray(2.0 * np.bincount(region, weights=surface.area[faces]) / np.maximum(perimeter, 1e-12))


def _inwards(surface: MergedMesh, points: Floats, face: Int64s) -> Floats:
    """Move points towards the centres of their faces by `_INWARDS`, at most half the way."""
    way = surface.points[surface.triangles[face]].mean(axis=1) - points
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-12)
    return np.asarray(points + np.minimum(_INWARDS / length, 0.5)[:, None] * way)


def _carried_edges(
    found: JudgedOverhangs, points: Floats, owner: Int64s, starts: Bools, reaches: Reaches, plate: float
) -> Bools:
    """Tell which samples on knife edges the part itself carries."""
    surface = found.surface
    merged = np.zeros(int(surface.first.max(initial=-1)) + 1, np.int64)
    merged[surface.first] = np.arange(len(surface.first))
    ends = merged[found.overhangs.edges.astype(np.int64)]
    if not len(points):
        return np.zeros(0, np.bool_)
    region = labels(ends.reshape(-1), np.repeat(np.arange(len(ends)), 2), len(ends))
    in_air = np.zeros(int(region.max()) + 1, np.bool_)
    in_air[region[starts[ends].any(axis=1)]] = True
    is_carried = carried_along(surface, ends, points, owner, reaches, plate)
    return np.asarray(is_carried & ~in_air[region[owner]])
