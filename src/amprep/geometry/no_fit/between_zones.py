"""A position of one shape in an empty build among forbidden zones."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.boxes.build_space import Space
from amprep.geometry.no_fit.circle import outline_of
from amprep.geometry.no_fit.contacts import contact_shapes
from amprep.geometry.no_fit.pieces import shape_set
from amprep.kernels.guided_search import EVERYWHERE
from amprep.kernels.no_fit.contacts import WORK, find_contacts
from amprep.kernels.no_fit.records import ShapeLayout

PLACES = (24, 24, 8)
"""Number of positions along each axis that are tried."""


def find_between_zones(pieces: Sequence[Floats], space: Space) -> Floats | None:
    """Return a position of the least corner ``(3,)`` mm at which a shape is inside and outside all zones.

    The lowest one of a grid is taken, with the first and last position along each axis; None if there is none. A shape
    that fits only between the positions of the grid is not found.

    Parameters
    ----------
    pieces
        For each convex piece its points ``(k, 3)`` mm, relative to the least corner.
    """
    zones = [
        np.array(list(product(*zip(lo, hi, strict=True))))
        for lo, hi in zip(space.zone_lo, space.zone_hi, strict=True)
        if (hi > lo).all()
    ]
    contacts = contact_shapes(shape_set([pieces], [[zone] for zone in zones], [0.0] * (1 + len(zones))))
    points = np.concatenate(pieces)
    outline, room = outline_of(points[:, :2]), space.hi - points.max(axis=0)
    if (room < space.lo - space.slack).any():
        return None
    axes = [np.linspace(lo, max(lo, hi), n) for lo, hi, n in zip(space.lo, room, PLACES, strict=True)]
    pairs, planes, work = np.zeros((0, 2), np.int64), np.zeros((0, 4)), np.empty(WORK)
    layout = ShapeLayout(
        np.arange(1 + len(zones)), np.full(1 + len(zones), EVERYWHERE), np.zeros((1 + len(zones), 3))
    )
    for position in np.stack(np.meshgrid(axes[2], axes[0], axes[1], indexing="ij"), axis=-1).reshape(-1, 3):
        layout.position[0] = position[[1, 2, 0]]
        from_axis = outline + layout.position[0, :2] - space.axis
        if space.radius and np.hypot(*from_axis.T).max() > space.radius + space.slack:
            continue
        if find_contacts(contacts, layout, 1, 0.0, pairs, planes, work)[1] >= 0.0:
            return np.array(layout.position[0])
    return None
