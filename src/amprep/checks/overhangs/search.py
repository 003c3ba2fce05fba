"""Find overhanging faces, knife edges and tips."""

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.checks.overhangs.starts import plateaus, starts_in_air
from amprep.checks.overhangs.surface import LEVEL, MergedMesh, labels, large_enough
from amprep.geometry.overhangs.regions import Overhangs
from amprep.model.supports.rules import OverhangRules

ROUNDING = 1e-4
"""Error (mm) that rounding in a file causes in heights; within it the planner has the benefit of the doubt."""


def find_overhangs(
    surface: MergedMesh, rules: OverhangRules, angle: float, enforced: Bools, blocked: Bools
) -> Overhangs:
    """Return overhanging faces, knife edges and tips (angles in radians).

    With the rules of the thesis those that are too small are left out. With limits none is, but a dip of less than a
    layer is no start in the air.
    """
    plate = rules.plate_mm + (ROUNDING if rules.has_limits else 0.0)
    smallest, shortest = (0.0, 0.0) if rules.has_limits else (rules.min_area_mm2, rules.min_length_mm)
    above = surface.points[surface.triangles, 2].max(axis=1) > plate
    steep = (above & (-surface.normal[:, 2] > np.cos(angle))) | enforced
    starts = starts_in_air(surface, plate, rules.layer_mm if rules.has_limits else 0.0)
    sharp = knife_edges(surface, steep, angle, plate)
    touched = np.zeros(len(surface.points), np.bool_)
    touched[surface.triangles[steep]] = True
    touched[surface.ends[sharp]] = True
    plateau = plateaus(surface)
    tips = np.flatnonzero(starts & ~np.isin(plateau, plateau[touched]))

    at_blocked = np.zeros(len(surface.points), np.bool_)
    at_blocked[surface.triangles[blocked]] = True
    faces = np.flatnonzero(steep & ~blocked)
    label = labels(surface.edge[faces].reshape(-1), np.repeat(np.arange(len(faces)), 3), len(faces))
    kept = large_enough(label, surface.area[faces], smallest)
    kept |= np.isin(label, label[starts[surface.triangles[faces]].any(axis=1) | enforced[faces]])
    sharp = sharp[~at_blocked[surface.ends[sharp]].all(axis=1)]
    ends = surface.ends[sharp]
    label = labels(ends.reshape(-1), np.repeat(np.arange(len(ends)), 2), len(ends))
    length = np.linalg.norm(surface.points[ends[:, 1]] - surface.points[ends[:, 0]], axis=1)
    long = large_enough(label, length, shortest) | np.isin(label, label[starts[ends].any(axis=1)])
    faces, ends, tips = faces[kept], surface.first[ends[long]], surface.first[tips[~at_blocked[tips]]]
    kinds = (np.full(len(each), kind, np.int32) for kind, each in enumerate((faces, ends, tips)))
    face_kind, edge_kind, tip_kind = kinds
    return Overhangs(
        faces.astype(np.int32),
        face_kind,
        ends.astype(np.int32),
        edge_kind,
        tips.astype(np.int32),
        tip_kind,
        (),
    )


def knife_edges(surface: MergedMesh, steep: Bools, angle: float, plate: float) -> Int64s:
    """Return the edges flatter than the angle from which all faces rise, with the solid above them."""
    start, end = (surface.points[surface.ends[:, i]] for i in (0, 1))
    along = end - start
    length = np.linalg.norm(along, axis=1)
    flat = (np.abs(along[:, 2]) < length * np.sin(angle)) & (np.maximum(start[:, 2], end[:, 2]) > plate)
    edge, face = surface.edge.reshape(-1), np.repeat(np.arange(len(surface.triangles)), 3)
    sound = (surface.triangles != np.roll(surface.triangles, 1, axis=1)).all(axis=1)[face]
    opposite = np.roll(surface.triangles, -2, axis=1).reshape(-1)
    unit = along / np.where(length > 0, length, 1.0)[:, None]
    ray = surface.points[opposite] - start[edge]
    ray -= np.einsum("ij,ij->i", ray, unit[edge])[:, None] * unit[edge]
    height = np.linalg.norm(
        ray, axis=1
    )  # of the triangle above the edge; of degenerate ones it is mere rounding
    falls = (ray[:, 2] <= LEVEL * height) | (height <= LEVEL) | steep[face]
    rising = np.bincount(edge, weights=falls & sound, minlength=len(along)) == 0
    faces = np.bincount(edge, weights=sound, minlength=len(along))
    down = np.bincount(edge, weights=surface.normal[face, 2], minlength=len(along)) < 0
    return np.flatnonzero(flat & rising & (down | (faces == 1)) & (faces > 0))
