"""Tell which sample points of overhangs need a contact: those that the part itself does not carry.

With the rules of the thesis all of them do. With limits the judge flags only what is certainly not carried: it grants
the planner `GRANT_MM` on every limit. Where the part starts in the air, the start needs contacts, and so does what only
higher anchors would carry, because these are printed later. A level start that is wide carries what is beside it. So
does another body of the part that touches the face from below.
"""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.overhangs.along_edges import carried_along
from amprep.checks.overhangs.bases import JudgedStarts, judged_starts, widths, with_bases
from amprep.checks.overhangs.borders import region_edges, regions_of
from amprep.checks.overhangs.joints import stand_on_bodies
from amprep.checks.overhangs.lines import Reaches, carried
from amprep.checks.overhangs.samples import ENFORCED, JudgedOverhangs
from amprep.checks.overhangs.search import ROUNDING
from amprep.checks.overhangs.starts import starts_in_air
from amprep.checks.overhangs.surface import LEVEL, MergedMesh, labels
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
    in_air = starts_in_air(found.surface, plate, rules.layer_mm + sign * ROUNDING)
    faces, climb = found.overhangs.faces.astype(np.int64), max(rules.layer_mm + sign * GRANT_MM, 0.0)
    starts = judged_starts(found.surface, faces, in_air, rules.ledge_mm, climb, sign)
    samples = found.samples.chosen(rows)
    needed = samples.points[:, 2] > plate
    on_faces = np.flatnonzero(needed & (samples.kind == 0) & (samples.owner != ENFORCED))
    needed[on_faces] = ~_carried_faces(
        found, samples.points[on_faces], samples.owner[on_faces], starts, reaches, plate, not strict
    )
    on_faces = on_faces[needed[on_faces]]
    inner = _inwards(found.surface, samples.points[on_faces], faces[samples.owner[on_faces]])
    reach = 0.0 if strict else max(reaches.ledge, reaches.bridge / 2.0)
    needed[on_faces] = ~stand_on_bodies(found.surface, inner, reach)
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
    starts: JudgedStarts,
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
    edges = region_edges(surface, faces, region, reaches.angle, plate, strict=not thorough)
    edges = with_bases(edges, surface, faces, starts.wide)
    corners = surface.triangles[faces]
    touching, in_air = np.zeros((2, int(region.max()) + 1), np.bool_)
    touching[region[starts.points[corners].any(axis=1)]] = True
    in_air[region[starts.level[faces] | starts.pointed[corners].any(axis=1)]] = True
    is_carried = ((widths(surface, faces, region) <= _NOISE) & ~in_air)[region[owner]]
    lowest = np.where(starts.pointed[corners], surface.points[corners, 2], -np.inf).max(axis=1)
    at_start = starts.level[faces[owner]] | (points[:, 2] <= lowest[owner] + LEVEL)
    rows = np.flatnonzero(~at_start & ~is_carried)
    inner, own = _inwards(surface, points[rows], faces[owner[rows]]), region[owner[rows]]
    climb = np.where(touching[own], starts.climb, np.inf)
    is_carried[rows] = carried(inner, own, edges, reaches, climb, thorough=thorough)
    return is_carried


def _inwards(surface: MergedMesh, points: Floats, face: Int64s) -> Floats:
    """Move points towards the centres of their faces by `_INWARDS`, at most half the way."""
    way = surface.points[surface.triangles[face]].mean(axis=1) - points
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-12)
    return np.asarray(points + np.minimum(_INWARDS / length, 0.5)[:, None] * way)


def _carried_edges(
    found: JudgedOverhangs,
    points: Floats,
    owner: Int64s,
    starts: JudgedStarts,
    reaches: Reaches,
    plate: float,
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
    in_air[region[starts.pointed[ends].any(axis=1)]] = True
    held = np.zeros(len(surface.points), np.bool_)
    held[surface.triangles[starts.wide]] = True
    is_carried = carried_along(surface, ends, points, owner, reaches, plate, held)
    return np.asarray(is_carried & ~in_air[region[owner]])
