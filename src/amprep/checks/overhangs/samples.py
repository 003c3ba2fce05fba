"""Find and sample overhangs for the judge of coverage; no code is shared with the planner's search.

Strategy. The planner decides from sections and from the order of faces around an edge whether the solid is above an
edge or a tip. The judge uses pseudonormals instead (Baerentzen and Aanaes, 2005, DOI 10.1109/TVCG.2005.49): where
all faces rise, the point just below is outside exactly if the sum of the face normals, at a vertex weighted by the
angles, points down. Blockers and enforcers do not cut triangles here; they select sample points. Their borders are
uncertain, and within them the judge gives the planner the benefit of the doubt.
"""

from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.checks.overhangs.modifiers import enforced_points, in_blockers, whole_triangles
from amprep.checks.overhangs.search import find_overhangs
from amprep.checks.overhangs.surface import MergedMesh, components, faces_down, surface_of
from amprep.geometry.meshes.sampling import sample_overhangs
from amprep.geometry.overhangs.regions import Overhangs
from amprep.model.build import PlacedPart
from amprep.model.supports.rules import OverhangRules

KINDS = ("face", "edge", "tip")
"""Kinds of overhangs, which samples have the indices of."""

GRANT_DEG = 0.02
"""Faces and edges this close to the overhang angle need no support, whatever rounding in a file makes of them."""

ENFORCED = -1
"""Owner of a sample that needs support because of an enforcer."""


class JudgedSamples(NamedTuple):
    """Points on overhangs.

    Attributes
    ----------
    points
        ``(n, 3)`` mm.
    kind
        ``(n,)`` index into `KINDS`.
    owner
        ``(n,)`` index of the face, edge or tip in the overhangs, or `ENFORCED`.
    """

    points: Floats
    kind: Int64s
    owner: Int64s

    def chosen(self, rows: Bools | Int64s) -> "JudgedSamples":
        """Return some of the samples."""
        return JudgedSamples(self.points[rows], self.kind[rows], self.owner[rows])


class JudgedOverhangs(NamedTuple):
    """The overhangs of a placed part as the judge finds them.

    Attributes
    ----------
    surface
        The mesh of the part.
    angle
        Overhang angle, radians.
    overhangs
        Faces, edges (as vertices of the mesh) and tips; with limits also those that the part itself carries.
    samples
        Points on them.
    """

    surface: MergedMesh
    angle: float
    overhangs: Overhangs
    samples: JudgedSamples


def judged_overhangs(
    placed: PlacedPart, rules: OverhangRules, spacing: float, grant_deg: float = GRANT_DEG
) -> JudgedOverhangs:
    """Return the overhangs of a placed part with sample points on them.

    Parameters
    ----------
    placed
        The part in the build; its own angle, blockers and enforcers count.
    rules
        Overhang angle, smallest area and smallest length; with limits no overhang is left out.
    spacing
        Distance of the points, mm.
    grant_deg
        Faces and edges this close to the overhang angle are no overhangs; with a negative value, those that are steeper
        by its amount are overhangs too.
    """
    regions, own, mesh = placed.part.regions, placed.part.overrides, placed.mesh
    angle = rules.overhang_angle_deg if own.overhang_angle_deg is None else own.overhang_angle_deg
    angle = float(np.radians(max(angle - grant_deg, 0.0)))
    surface = surface_of(mesh)
    if own.supports is False or not len(mesh.triangles):
        return JudgedOverhangs(surface, angle, _none(), _no_samples())
    down = faces_down(surface, rules.plate_mm)
    every = np.arange(len(mesh.triangles))
    enforced = np.isin(every, whole_triangles(regions, "enforcer")) & down
    blocked = np.isin(every, whole_triangles(regions, "blocker"))
    found = find_overhangs(surface, rules, angle, enforced, blocked)
    samples = _samples_of(placed, found, spacing)
    on_faces = np.flatnonzero(samples.kind == 0)
    samples.owner[on_faces[enforced[found.faces][samples.owner[on_faces]]]] = ENFORCED
    more = enforced_points(placed, down, spacing)
    added = JudgedSamples(more, np.zeros(len(more), np.int64), np.full(len(more), ENFORCED))
    samples = JudgedSamples(*(np.concatenate(each) for each in zip(samples, added, strict=True)))
    free = ~in_blockers(samples.points, placed)
    if not free.all():
        samples = samples.chosen(free)
        if not rules.has_limits:
            samples = _without_small_patches(samples, spacing, rules.min_area_mm2)
    return JudgedOverhangs(surface, angle, found, samples)


def _samples_of(placed: PlacedPart, found: Overhangs, spacing: float) -> JudgedSamples:
    """Sample faces, edges and tips; each of them counts as a region of its own."""
    faces, edges, tips = len(found.faces), len(found.edges), len(found.tips)
    number = np.arange(faces + edges + tips, dtype=np.int32)
    single = found._replace(
        face_region=number[:faces],
        edge_region=number[faces : faces + edges],
        tip_region=number[faces + edges :],
    )
    sampled = sample_overhangs(placed.mesh.vertices, placed.mesh.triangles, single, spacing)
    kind = np.searchsorted([faces, faces + edges], sampled.region, side="right")
    owner = sampled.region - np.array([0, faces, faces + edges])[kind]
    return JudgedSamples(sampled.points, kind, owner)


def _none() -> Overhangs:
    none = np.empty(0, np.int32)
    return Overhangs(none, none, np.empty((0, 2), np.int32), none, none, none, ())


def _no_samples() -> JudgedSamples:
    return JudgedSamples(np.empty((0, 3)), np.empty(0, np.int64), np.empty(0, np.int64))


def _without_small_patches(samples: JudgedSamples, spacing: float, min_area: float) -> JudgedSamples:
    """Remove the patches of samples, left over by blockers, that may be smaller than the smallest area."""
    from scipy.spatial import KDTree

    pairs = KDTree(samples.points).query_pairs(2.0 * spacing, output_type="ndarray")
    label = components(pairs[:, 0], pairs[:, 1], len(samples.points))
    large = np.bincount(label)[label] * spacing**2 >= 4.0 * min_area
    return samples.chosen(large)
