"""Bounds on the objective from the volumes of the items, valid for any shape."""

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.geometry.boxes.build_space import union_volume
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.annealing.scene import PreparedVolumes, inner_corners


def solid_volume(volume: BoundingVolume) -> float:
    """Return the volume of a bounding volume, mm3; of convex pieces, which may overlap, that of the largest one."""
    if isinstance(volume, Boxes):
        return float(union_volume(volume.lo, volume.hi))
    if isinstance(volume, ConvexPieces):
        return max(abs(piece.signed_volume) for piece in volume.pieces)
    return abs(volume.mesh.signed_volume)


def objective_bound(prepared: PreparedVolumes, items: list[int], volumes: Floats, start: Packing) -> float:
    """Return a bound on the objective: the volume of the items against that of the build, and least heights.

    For `fill` and `builds` of boxes in listed orientations, it is at least as good as the bound of the first layout.

    Parameters
    ----------
    prepared
        The volumes.
    items
        Items that are not too large for a build, without the fixed ones.
    volumes
        ``(n,)`` mm3, volume of every item.
    start
        The first layout, of enclosing boxes.
    """
    problem = prepared.problem
    room = _room(problem)
    same = all(isinstance(i.volume, Boxes) and i.orientations.freedom == "list" for i in problem.items)
    known = start.bound if same else None
    if problem.objective == "height":
        base = room / max(float(problem.space.size[2]) - problem.lift, 1e-9)
        return problem.lift + max(float(volumes[items].sum()) / base, _least_height(prepared, items))
    if problem.objective == "builds":
        needed = int(np.ceil(float(volumes[items].sum()) / room - 1e-9)) if items else 0
        needed = max(needed, 1 if items or problem.fixed else 0)
        return float(needed) if known is None else max(float(needed), known)
    return min(_knapsack(problem, items, volumes, room), np.inf if known is None else known)


def _room(problem: PackingProblem) -> float:
    """Return the volume for items in one build, mm3, with the tolerance of contact."""
    low, high = inner_corners(problem)
    size = np.maximum(high - low, 0.0) + 2.0 * CONTACT_TOLERANCE
    area = np.pi / 4.0 * size[0] * size[0] if problem.space.shape == "cylinder" else size[0] * size[1]
    return float(area * (problem.space.size[2] - problem.lift + 2.0 * CONTACT_TOLERANCE))


def _least_height(prepared: PreparedVolumes, items: list[int]) -> float:
    """Return the height of the item that is highest in its lowest orientation, mm; 0 for items without a limit."""
    heights = [0.0]
    for item in items:
        orientations = prepared.problem.items[item].orientations
        if orientations.freedom != "free":
            points = prepared.points[prepared.shape_of[item]]
            ups = orientations.matrices[:, 2] if orientations.freedom == "list" else np.eye(3)[2:]
            heights.append(float(np.ptp(points @ ups.T, axis=0).min()))
    return max(heights)


def _knapsack(problem: PackingProblem, items: list[int], volumes: Floats, room: float) -> float:
    """Return the fractional knapsack of values over volumes, with the fixed items."""
    value = np.array([item.value for item in problem.items])
    aside = float(sum(value[placement.item] for placement in problem.fixed))
    order = sorted(items, key=lambda i: -value[i] / max(volumes[i], 1e-12))
    for item in order:
        fraction = min(1.0, room / volumes[item]) if volumes[item] > 0.0 else 1.0
        aside += fraction * float(value[item])
        room = max(room - float(volumes[item]), 0.0)
    return aside
