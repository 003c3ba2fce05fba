"""Bounds that no packing can beat: least number of builds, greatest value and least height of one build.

All bounds are valid for every packing that the judge accepts: distances are Euclidean, and every contact may be
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
from amprep.plugins.packers.bounds.dual_feasible import greatest_scale
from amprep.plugins.packers.bounds.l2 import grown_volume, l2_bound
from amprep.plugins.packers.instance.prepare import Orientation, PreparedInstance

UNITS = (1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02)
"""Units (mm): where all lengths are multiples of one of them, the tolerance makes no difference."""


class Amounts(NamedTuple):
    """Volume or plate area that each item type takes at least ``(types,)``, and that of the room, with clearance."""

    taken: Floats
    room: float


class RelaxedBoxes(NamedTuple):
    """Sides of a box for each type ``(types, 3)`` and of the room ``(3,)``, mm.

    Every packing that the judge accepts is also a packing of these boxes, without clearance and tolerance.
    """

    size: Floats
    room: Floats


def packing_bound(instance: PreparedInstance) -> float:
    """Return the bound on the objective: `fill_bound`, `height_bound` or `builds_bound`."""
    if instance.filling:
        return fill_bound(instance)
    return height_bound(instance) if instance.in_one_build else float(builds_bound(instance))


def builds_bound(instance: PreparedInstance) -> int:
    """Return a lower bound on the builds: the greatest of volume, plate area, `l2_bound` and conservative scales.

    Without stacking every item counts as high as the room, which makes the latter two bounds for the plane.
    """
    counted = instance.type_of[counted_items(instance)]
    if not len(counted):
        return 1 if instance.problem.fixed else 0
    bound = 1
    for amounts in amounts_of(instance):
        bound = max(bound, int(np.ceil(amounts.taken[counted].sum() / amounts.room - 1e-9)))
    size, room, gap = core_sizes(instance), core_room(instance), instance.problem.clearance
    boxes, demand = relaxed_boxes(instance), np.bincount(counted, minlength=len(instance.types))
    weight = greatest_scale(boxes.size / boxes.room, demand)
    return max(bound, l2_bound(size[counted], room, gap), int(np.ceil(weight - 1e-6)))


def fill_bound(instance: PreparedInstance) -> float:
    """Return an upper bound on the value of one build: the fractional knapsacks over volume and plate area."""
    items = instance.problem.items
    value = np.array([max(item.value, 0.0) for item in items])
    inside = counted_items(instance)
    aside = float(value[~inside & ~instance.too_large].sum())
    bound = float(value[inside].sum())
    for taken, room in amounts_of(instance):
        weight = taken[instance.type_of]
        order = np.flatnonzero(inside)[
            np.argsort(-value[inside] / np.maximum(weight[inside], 1e-12), kind="stable")
        ]
        full = np.cumsum(weight[order])
        fraction = np.clip((room - (full - weight[order])) / np.maximum(weight[order], 1e-12), 0.0, 1.0)
        bound = min(bound, float((fraction * value[order]).sum()))
    return aside + bound


def height_bound(instance: PreparedInstance) -> float:
    """Return a lower bound on the height (mm) of one build: fixed items, the highest item, and the volume.

    Grown by half the clearance, the items are disjoint, and share a room that reaches half a clearance beyond.
    """
    gap, lift = instance.problem.clearance, instance.problem.lift
    least = np.array([min(o.size[2] for o in item_type) for item_type in instance.types] or [0.0])
    highest = float(least[instance.type_of[instance.free]].max(initial=-lift)) + lift
    inside, taken = counted_items(instance), _taken(instance, 3)
    known = max(highest, float(instance.fixed_hi[:, 2].max(initial=0.0)))
    if not inside.any():
        return known
    filled = float(taken[instance.type_of[inside]].sum()) / max(_base_area(instance), 1e-12)
    return max(known, filled + lift - gap - 2.0 * CONTACT_TOLERANCE)


def counted_items(instance: PreparedInstance) -> Bools:
    """Return the items that certainly take room, ``(n,)`` bool: free items, and fixed ones that keep the rules.

    Fixed items are not judged: their boxes may overlap, be turned, or be outside the build volume.
    """
    return instance.free | (~instance.too_large & _fixed_keep_the_rules(instance))


def _fixed_keep_the_rules(instance: PreparedInstance) -> bool:
    """Return whether the fixed placements alone are a packing that the judge accepts."""
    fixed = instance.problem.fixed
    if not fixed:
        return True
    others = sorted(set(range(len(instance.type_of))) - {placement.item for placement in fixed})
    alone = Packing((fixed,), tuple(Unplaced(item, "not asked for") for item in others))
    return not check_packing(replace(instance.problem, fixed=()), alone)


def amounts_of(instance: PreparedInstance) -> list[Amounts]:
    """Return the volumes and, without stacking, the plate areas."""
    dimensions = (3, 2) if instance.space.flat else (3,)
    return [Amounts(_taken(instance, d), _available(instance, d)) for d in dimensions]


def _taken(instance: PreparedInstance, dimensions: int) -> Floats:
    """Return the least volume or plate area of each item type over its orientations, ``(types,)``."""
    radius = max(instance.problem.clearance - CONTACT_TOLERANCE, 0.0) / 2.0
    orientations = instance.orientations
    lo = np.concatenate([orientation.lo for orientation in orientations] or [np.empty((0, 3))])
    hi = (
        np.concatenate([orientation.hi for orientation in orientations] or [np.empty((0, 3))])
        - CONTACT_TOLERANCE
    )
    side = np.maximum(hi - lo, 0.0)[:, :dimensions]
    if dimensions == 2:
        # only boxes on the plate are certainly beside each other, and flat ones only where a clearance is kept
        low = (lo[:, 2] <= CONTACT_TOLERANCE) & ((hi[:, 2] > lo[:, 2]) | (radius > 0.0))
        side, hi = side * low[:, None], np.where(low[:, None], hi, lo)
    box = np.cumsum([0, *(len(v.lo) for v in orientations)])
    grown = np.maximum.reduceat(_grown(side, radius), box[:-1]) if orientations else np.empty(0)
    for v in np.flatnonzero(np.diff(box) > 1).tolist():
        own = slice(box[v], box[v + 1])
        grown[v] = max(grown[v], union_volume(lo[own, :dimensions], hi[own, :dimensions]))
    first = instance.first_orientation[:-1]
    return np.asarray(np.minimum.reduceat(grown, first) if len(grown) else grown)


def _grown(side: Floats, radius: float) -> Floats:
    """Return the measures of boxes ``(k, 2)`` or ``(k, 3)`` grown by a ball; an empty box counts 0."""
    faces, measure = side.sum(axis=1), side.prod(axis=1)
    in_plane = side.shape[1] == 2
    grown = measure + 2.0 * radius * faces + np.pi * radius**2 if in_plane else grown_volume(side, radius)
    return np.asarray(np.where(measure > 0.0, grown, 0.0))


def _available(instance: PreparedInstance, dimensions: int) -> float:
    """Return the volume or plate area that grown items share in an empty build."""
    space, gap = instance.space, instance.problem.clearance
    side = space.hi - space.lo + gap + 2.0 * CONTACT_TOLERANCE
    if (side <= 0.0).any():
        return 1e-12
    whole = _base_area(instance) * (side[2] if dimensions == 3 else 1.0)
    return max(float(whole) - _lost(instance, dimensions), 1e-12)


def _base_area(instance: PreparedInstance) -> float:
    """Return the plate area that grown items share."""
    space, gap = instance.space, instance.problem.clearance
    if space.radius:
        return float(np.pi * (space.radius + gap / 2.0 + CONTACT_TOLERANCE) ** 2)
    return float(np.prod(space.hi[:2] - space.lo[:2] + gap + 2.0 * CONTACT_TOLERANCE))


def _lost(instance: PreparedInstance, dimensions: int) -> float:
    """Return the volume or plate area of the forbidden zones, less the margin that grown items may enter."""
    space = instance.space
    margin = instance.problem.clearance / 2.0 + CONTACT_TOLERANCE
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


def core_room(instance: PreparedInstance) -> Floats:
    """Return the sides of the room, larger by the tolerance, ``(3,)`` mm."""
    return np.asarray(instance.space.hi - instance.space.lo + CONTACT_TOLERANCE)


def core_sizes(instance: PreparedInstance) -> Floats:
    """Return for each type a box ``(types, 3)`` mm that is inside it in every orientation, smaller by the tolerance.

    Its sides are the least sides of the largest boxes. Without stacking it is as high as the room.
    """
    sizes = np.array(
        [np.min([_core(each, instance) for each in item_type], axis=0) for item_type in instance.types]
    )
    return np.asarray(np.maximum(sizes.reshape(-1, 3) - CONTACT_TOLERANCE, 0.0))


def _core(orientation: Orientation, instance: PreparedInstance) -> Floats:
    """Return the sides of the largest box; without stacking only boxes on the plate count."""
    side = orientation.hi - orientation.lo
    if instance.space.flat:
        thick = (side[:, 2:] > CONTACT_TOLERANCE) | (instance.problem.clearance > CONTACT_TOLERANCE)
        side = np.where((orientation.lo[:, 2:] <= CONTACT_TOLERANCE) & thick, side, 0.0)
        side[:, 2] = core_room(instance)[2] - CONTACT_TOLERANCE  # the height of the room
    return np.asarray(side[side.prod(axis=1).argmax()] if len(side) > 1 else side[0])


def relaxed_boxes(instance: PreparedInstance) -> RelaxedBoxes:
    """Return boxes without clearance and tolerance such that every accepted packing is a packing of them.

    Two points at least d apart in space differ by d / sqrt(3) along some axis. Every box and the room grow by that;
    boxes that keep the clearance then do not overlap.
    """
    size, room = core_sizes(instance), core_room(instance)
    dimensions = 2.0 if instance.space.flat else 3.0
    gap = max(instance.problem.clearance - CONTACT_TOLERANCE, 0.0) / np.sqrt(dimensions)
    whole, unit = size + CONTACT_TOLERANCE, 0.0
    if gap == 0.0:
        unit = _unit(whole, room - CONTACT_TOLERANCE)
    if unit:
        return RelaxedBoxes(np.round(whole / unit) * unit, np.round(room / unit) * unit)
    return RelaxedBoxes(size + gap, room + gap)


def _unit(size: Floats, room: Floats) -> float:
    """Return the unit of all lengths, or 0 when there is none or the tolerances of a row add up to a unit."""
    lengths = np.append(size.ravel(), room)
    most = (room / np.maximum(size.min(axis=0, initial=np.inf), 1e-9)).max(initial=0.0)
    for unit in UNITS:
        if np.abs(lengths / unit - np.round(lengths / unit)).max() < 1e-6:
            return unit if (most + 2.0) * CONTACT_TOLERANCE < unit else 0.0
    return 0.0
