"""Judge a proposed orientation: it is a rotation, and its figures are those of the part in it."""

from collections.abc import Iterator

import numpy as np

from amprep.arrays import Floats, Int64s, Ints
from amprep.checks.overhangs.needs import are_needed
from amprep.checks.overhangs.samples import JudgedSamples, judged_overhangs
from amprep.checks.violation import Violation
from amprep.model.build import PlacedPart
from amprep.model.orientation import OrientationFigures, OrientationProposal
from amprep.model.part import Part
from amprep.model.supports.rules import SupportRules

PROMISE = "orientation"

_LENGTH_MM = 1e-6
_FRACTION, _AREA_MM2 = 0.05, 1.0
"""Errors of areas and volumes that sampling causes: a fraction, and an area; times the height of the part a volume."""

_STEP_MM = 0.125
"""Mean distance from a limit at which planning divides triangles; an error along the borders of overhangs."""

_TIPPING_DEG = 0.2
_DIRECTIONS = 3600
_FEWEST_POINTS, _MOST_POINTS, _PER_MM2 = 500, 20_000, 2.0
"""Number of random points on overhangs: for each area, and its bounds."""


def check_proposal(
    part: Part, proposal: OrientationProposal, rules: SupportRules, lift: float
) -> list[Violation]:
    """Judge an orientation of a part from its mesh alone.

    What needs support is found by the judge's own search at random points of the downward faces.

    Parameters
    ----------
    part
        The part; its own angle, blockers and enforcers count.
    proposal
        The orientation with its figures.
    rules
        Overhang angle and limits.
    lift
        Height (mm) of the lowest point of the part above the plate.
    """
    rotation = proposal.rotation
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-9 or np.linalg.det(rotation) < 0.0:
        return [Violation(PROMISE, part.name, "expected a rotation, found a matrix that is none")]
    points = part.mesh.vertices @ rotation.T
    points[:, 2] += lift - points[:, 2].min()
    faults = (*_of_size(points, proposal.figures), *_of_stance(part, points, proposal.figures, rules))
    return [
        Violation(PROMISE, part.name, fault)
        for fault in (*faults, *_of_overhangs(part, proposal, points, rules))
    ]


def _of_size(points: Floats, figures: OrientationFigures) -> Iterator[str]:
    size = points.max(axis=0) - points.min(axis=0)
    if np.abs(size - figures.box_mm).max() > _LENGTH_MM or abs(size[2] - figures.height_mm) > _LENGTH_MM:
        stated, found = (" x ".join(f"{side:.6g}" for side in each) for each in (figures.box_mm, size))
        yield f"expected a box of {stated} mm, found {found} mm"


def _of_stance(part: Part, points: Floats, figures: OrientationFigures, rules: SupportRules) -> Iterator[str]:
    """Judge the tipping angle: in each direction in plan the lowest points reach so far beyond the centre of mass."""
    from trimesh.triangles import mass_properties

    if not part.is_solid:
        return
    corners = points[part.mesh.triangles]
    centre = np.asarray(mass_properties(corners)["center_mass"])
    lowest = points[points[:, 2] <= points[:, 2].min() + rules.plate_mm, :2] - centre[:2]
    turn = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    reach = (lowest @ np.array([np.cos(turn), np.sin(turn)])).max(axis=0).min()
    angle = float(np.degrees(np.arctan2(max(reach, 0.0), centre[2] - points[:, 2].min())))
    if abs(angle - figures.tipping_deg) > _TIPPING_DEG:
        yield f"expected to tip over at {figures.tipping_deg:.2f} degrees, found {angle:.2f}"


def _of_overhangs(
    part: Part, proposal: OrientationProposal, points: Floats, rules: SupportRules
) -> Iterator[str]:
    """Judge area and shadow of the overhangs: not less than what certainly needs support, nor more than what may."""
    matrix = np.eye(4)
    matrix[:3, :3] = proposal.rotation
    matrix[:3, 3] = points[0] - proposal.rotation @ part.mesh.vertices[0]
    found = judged_overhangs(PlacedPart(part.name, part, matrix), rules, 5.0)
    corners = points[part.mesh.triangles[found.overhangs.faces]]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(cross, axis=1) / 2.0
    count = int(np.clip(_PER_MM2 * areas.sum(), _FEWEST_POINTS, _MOST_POINTS))
    owner, where = _points_on(corners, areas, count)
    found = found._replace(samples=JudgedSamples(where, np.zeros(len(owner), np.int64), owner))
    each = float(areas.sum()) / max(len(owner), 1)
    level = -cross[owner, 2] / np.maximum(2.0 * areas[owner], 1e-300) * where[:, 2]
    least, most = (are_needed(found, rules, np.arange(len(owner)), strict=strict) for strict in (False, True))
    height = float(points[:, 2].max())
    slack = _AREA_MM2 + _STEP_MM * _border(points, part.mesh.triangles[found.overhangs.faces])
    for name, unit, stated, weight, error in (
        ("overhangs", "mm2", proposal.figures.overhang_mm2, np.full(len(owner), each), slack),
        ("a shadow volume", "mm3", proposal.figures.shadow_mm3, each * level, slack * height),
    ):
        low, high = float(weight[least].sum()), float(weight[most].sum())
        if not low * (1.0 - _FRACTION) - error <= stated <= high * (1.0 + _FRACTION) + error:
            yield f"expected {name} of {stated:.6g} {unit}, found {low:.6g} to {high:.6g}"


def _border(points: Floats, triangles: Ints) -> float:
    """Return the length (mm) of the edges that only one of the triangles ``(n, 3)`` has."""
    sides = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    ends, count = np.unique(sides, axis=0, return_counts=True)
    along = points[ends[count == 1]]
    return float(np.linalg.norm(along[:, 1] - along[:, 0], axis=1).sum())


def _points_on(corners: Floats, areas: Floats, count: int) -> tuple[Int64s, Floats]:
    """Return random points ``(n, 3)`` on triangles, as many for each as its area, and the triangle ``(n,)`` of each."""
    if not len(corners):
        return np.empty(0, np.int64), np.empty((0, 3))
    random = np.random.default_rng(0)
    end = np.cumsum(areas) / areas.sum()
    owner = np.minimum(np.searchsorted(end, (np.arange(count) + 0.5) / count), len(corners) - 1)
    u, v = random.random((2, count, 1))
    outside = u + v > 1.0
    u, v = np.where(outside, 1.0 - u, u), np.where(outside, 1.0 - v, v)
    a, b, c = (corners[owner, i] for i in range(3))
    return owner, a + u * (b - a) + v * (c - a)
