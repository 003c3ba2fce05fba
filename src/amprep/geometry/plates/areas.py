"""Areas that shadows take of a plate at least, whatever the layout."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.geometry.plates.outline import closed, sides_of
from amprep.geometry.plates.shadow import SEGMENTS

if TYPE_CHECKING:
    from manifold3d import CrossSection

# Strategy. Shadows that keep a clearance c are disjoint after each has been enlarged by c / 2, and so are they when the
# gaps that a disc of radius c cannot enter are filled first. They are inside the plate without a border of c / 2. So
# the areas of the enlarged shadows add up to at most the area inside this border. The clearance counts less by twice
# the tolerance of contacts. Circles are replaced by polygons inside them, which makes areas less.


def _counted(clearance: float) -> float:
    """Return the clearance that every packing keeps, mm."""
    return max(clearance - 2.0 * CONTACT_TOLERANCE, 0.0)


def needed_area(shadow: "CrossSection", clearance: float) -> float:
    """Return the area (mm2) that a shadow takes of a plate at least, with its part of the clearance."""
    from manifold3d import JoinType

    counted = _counted(clearance)
    if counted > 0.0:
        wider = closed(shadow, counted).offset(counted / 2.0, JoinType.Round, 2.0, SEGMENTS)
        return float(wider.area())
    sides = sides_of([np.asarray(loop) for loop in shadow.to_polygons()])
    length = float(np.hypot(sides[:, 2] - sides[:, 0], sides[:, 3] - sides[:, 1]).sum())
    return max(float(shadow.area()) - CONTACT_TOLERANCE * length, 0.0)


def plate_area(size: Floats, clearance: float, *, round_plate: bool) -> float:
    """Return the area (mm2) of a plate of a size ``(2,)`` mm that enlarged shadows may take."""
    border = clearance - CONTACT_TOLERANCE - _counted(clearance) / 2.0
    sides = np.maximum(np.asarray(size) - 2.0 * border, 0.0)
    return float(sides[0] * sides[1] * (np.pi / 4.0 if round_plate else 1.0))
