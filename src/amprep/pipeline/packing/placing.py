"""Place a part exactly where the file of its build will store it."""

import numpy as np

from amprep.model import Item, Part, PlacedPart, Placement
from amprep.threemf.transforms import round_as_stored


def placed_part(label: str, part: Part, item: Item, placement: Placement) -> PlacedPart:
    """Return the part of an item at the placement of its bounding volume."""
    turn = np.eye(4)
    turn[:3, :3] = item.turn
    return PlacedPart(label, part, round_as_stored(placement.matrix @ turn), part.orientations)
