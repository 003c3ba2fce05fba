"""What no packing can beat: lower bounds on the number of builds, upper bounds on the value of one build.

All bounds hold for every packing that the judge accepts: distances are Euclidean, and every contact may be
penetrated by `CONTACT_TOLERANCE`, so boxes count smaller and rooms larger by it. Items of several boxes are
relaxed to one of their boxes, or to the volume of their union.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.checks.packing.volumes_placed import check_packing
from amprep.geometry.boxes.build_space import union_volume
from amprep.model.packing import Packing, Unplaced
from amprep.plugins.packers.bounds.dual_feasible import heaviest_scale
from amprep.plugins.packers.bounds.l2 import grown_volume, l2_bound
from amprep.plugins.packers.bounds.relaxation import core_room, core_sizes, relaxed_boxes
from amprep.plugins.packers.instance.prepare import Scene


class Amounts(NamedTuple):
    """How much of the room each kind takes, at least, and how much there is; clearance included."""

    taken: Floats
    room: float


def builds_bound(scene: Scene) -> int:
    """Return the fewest builds that can hold what fits: by volume, plate area, `l2_bound` and scales.

    Without stacking every item counts as high as the room, which makes the latter bounds for the plane.
    """
    counted = scene.kind[counted_items(scene)]
    if not len(counted):
        return 1 if scene.problem.fixed else 0
    bound = 1
    for amounts in amounts_of(scene):
        bound = max(bound, int(np.ceil(amounts.taken[counted].sum() / amounts.room - 1e-9)))
    size, room, gap = core_sizes(scene), core_room(scene), scene.problem.clearance
    boxes, demand = relaxed_boxes(scene), np.bincount(counted, minlength=len(scene.kinds))
    weight = heaviest_scale(boxes.size / boxes.room, demand)
    return max(bound, l2_bound(size[counted], room, gap), int(np.ceil(weight - 1e-6)))


def fill_bound(scene: Scene) -> float:
    """Return a value that one build cannot exceed: the fractional knapsacks over volume and plate area."""
    items = scene.problem.items
    value = np.array([max(item.value, 0.0) for item in items])
    inside = counted_items(scene)
    aside = float(value[~inside & ~scene.too_large].sum())
    bound = float(value[inside].sum())
    for taken, room in amounts_of(scene):
        weight = taken[scene.kind]
        order = np.flatnonzero(inside)[
            np.argsort(-value[inside] / np.maximum(weight[inside], 1e-12), kind="stable")
        ]
        full = np.cumsum(weight[order])
        share = np.clip((room - (full - weight[order])) / np.maximum(weight[order], 1e-12), 0.0, 1.0)
        bound = min(bound, float((share * value[order]).sum()))
    return aside + bound


def counted_items(scene: Scene) -> Bools:
    """Return which items take their room for certain, ``(n,)`` bool: the free, and the fixed if they keep the rules.

    The boxes of fixed items may overlap, be turned or stand outside, for nobody judges them.
    """
    return scene.free | (~scene.too_large & _fixed_keep_the_rules(scene))


def _fixed_keep_the_rules(scene: Scene) -> bool:
    fixed = scene.problem.fixed
    if not fixed:
        return True
    others = sorted(set(range(len(scene.kind))) - {placement.item for placement in fixed})
    alone = Packing((fixed,), tuple(Unplaced(item, "not asked for") for item in others))
    return not check_packing(replace(scene.problem, fixed=()), alone)


def amounts_of(scene: Scene) -> list[Amounts]:
    """Return the volumes, and without stacking the plate areas."""
    dimensions = (3, 2) if scene.space.flat else (3,)
    return [Amounts(_taken(scene, d), _available(scene, d)) for d in dimensions]


def _taken(scene: Scene, dimensions: int) -> Floats:
    """Return the volume or plate area that each kind takes, at least, in its best orientation."""
    radius = max(scene.problem.clearance - CONTACT_TOLERANCE, 0.0) / 2.0
    variants = [variant for kind in scene.kinds for variant in kind]
    lo, hi = (
        np.concatenate([getattr(v, side) for v in variants] or [np.empty((0, 3))]) for side in ("lo", "hi")
    )
    hi = hi - CONTACT_TOLERANCE
    side = np.maximum(hi - lo, 0.0)[:, :dimensions]
    if dimensions == 2:
        # only boxes that stand on the plate are side by side for certain
        low = lo[:, 2] <= CONTACT_TOLERANCE
        side, hi = side * low[:, None], np.where(low[:, None], hi, lo)
    box = np.cumsum([0, *(len(v.lo) for v in variants)])
    grown = np.maximum.reduceat(_grown(side, radius), box[:-1]) if variants else np.empty(0)
    for v in np.flatnonzero(np.diff(box) > 1).tolist():
        own = slice(box[v], box[v + 1])
        grown[v] = max(grown[v], union_volume(lo[own, :dimensions], hi[own, :dimensions]))
    first = np.cumsum([0, *(len(kind) for kind in scene.kinds)])
    return np.asarray(np.minimum.reduceat(grown, first[:-1]) if len(grown) else grown)


def _grown(side: Floats, radius: float) -> Floats:
    """Return the measures of boxes ``(k, 2)`` or ``(k, 3)`` grown by a ball; 0 of what is no box."""
    faces, measure = side.sum(axis=1), side.prod(axis=1)
    in_plane = side.shape[1] == 2
    grown = measure + 2.0 * radius * faces + np.pi * radius**2 if in_plane else grown_volume(side, radius)
    return np.asarray(np.where(measure > 0.0, grown, 0.0))


def _available(scene: Scene, dimensions: int) -> float:
    """Return the volume or plate area that grown items share in an empty build."""
    space, gap = scene.space, scene.problem.clearance
    side = space.hi - space.lo + gap + 2.0 * CONTACT_TOLERANCE
    if (side <= 0.0).any():
        return 1e-12
    area = (
        side[0] * side[1]
        if space.radius == 0.0
        else np.pi * (space.radius + gap / 2.0 + CONTACT_TOLERANCE) ** 2
    )
    whole = area * (side[2] if dimensions == 3 else 1.0)
    return max(float(whole) - _lost(scene, dimensions), 1e-12)


def _lost(scene: Scene, dimensions: int) -> float:
    """Return the volume or plate area that zones surely take, less the margin that grown items may enter."""
    space = scene.space
    margin = scene.problem.clearance / 2.0 + CONTACT_TOLERANCE
    lo, hi = space.zone_lo + margin, space.zone_hi - margin
    if dimensions == 2:
        inside = (lo[:, 2] <= space.lo[2]) & (hi[:, 2] > space.lo[2])
        lo, hi = lo[inside], hi[inside]
    if space.radius:
        half = space.radius / np.sqrt(2.0)
        least, most = (
            np.array([*(space.axis - half), space.lo[2]]),
            np.array([*(space.axis + half), space.hi[2]]),
        )
    else:
        least, most = space.lo, space.hi
    lo, hi = np.maximum(lo, least)[:, :dimensions], np.minimum(hi, most)[:, :dimensions]
    return union_volume(lo, hi)
