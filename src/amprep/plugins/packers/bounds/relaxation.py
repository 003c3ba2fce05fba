"""Boxes that fit wherever the items do, without tolerance or clearance: what bounds by geometry reckon with."""

from typing import NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.plugins.packers.instance.prepare import Scene, Variant

UNITS = (1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02)
"""mm; when all lengths are multiples of one of them, tolerance makes no difference."""


class RelaxedBoxes(NamedTuple):
    """Sides ``(kinds, 3)`` and the room's ``(3,)``, mm: what the judge accepts is a packing of these too."""

    size: Floats
    room: Floats


def core_room(scene: Scene) -> Floats:
    """Return the sides of the room, ``(3,)`` mm, larger by the tolerance."""
    return np.asarray(scene.space.hi - scene.space.lo + CONTACT_TOLERANCE)


def core_sizes(scene: Scene) -> Floats:
    """Return a box ``(kinds, 3)`` within each kind however turned: of its largest boxes, the least sides.

    Without stacking it is as high as the room. Smaller by the tolerance.
    """
    sizes = np.array([np.min([_core(variant, scene) for variant in kind], axis=0) for kind in scene.kinds])
    return np.asarray(np.maximum(sizes.reshape(-1, 3) - CONTACT_TOLERANCE, 0.0))


def _core(variant: Variant, scene: Scene) -> Floats:
    """Return the sides of a variant's largest box; without stacking, of those that stand on the plate."""
    side = variant.hi - variant.lo
    if scene.space.flat:
        side = np.where(variant.lo[:, 2:] <= CONTACT_TOLERANCE, side, 0.0)
        side[:, 2] = core_room(scene)[2] - CONTACT_TOLERANCE  # as high as the room is
    return np.asarray(side[side.prod(axis=1).argmax()] if len(side) > 1 else side[0])


def relaxed_boxes(scene: Scene) -> RelaxedBoxes:
    """Return the relaxation; of two boxes that keep a clearance apart, one axis sees its share of it.

    Points at least d apart in space differ by d / sqrt(3) along some axis. Every box and the room grow by that,
    and boxes that are apart then touch at most.
    """
    size, room = core_sizes(scene), core_room(scene)
    gap = max(scene.problem.clearance - CONTACT_TOLERANCE, 0.0) / np.sqrt(2.0 if scene.space.flat else 3.0)
    whole, unit = size + CONTACT_TOLERANCE, 0.0
    if gap == 0.0:
        unit = _unit(whole, room - CONTACT_TOLERANCE)
    if unit:
        return RelaxedBoxes(np.round(whole / unit) * unit, np.round(room / unit) * unit)
    return RelaxedBoxes(size + gap, room + gap)


def _unit(size: Floats, room: Floats) -> float:
    """Return the unit of all lengths when a row of boxes is too short for its slack to add up to a unit; or 0."""
    lengths = np.append(size.ravel(), room)
    most = (room / np.maximum(size.min(axis=0, initial=np.inf), 1e-9)).max(initial=0.0)
    for unit in UNITS:
        if np.abs(lengths / unit - np.round(lengths / unit)).max() < 1e-6:
            return unit if (most + 2.0) * CONTACT_TOLERANCE < unit else 0.0
    return 0.0
