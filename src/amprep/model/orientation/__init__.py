"""Records of the search for the orientation in which a part is built."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.validation import require, require_bounds

EDGE_MM, HOLD_MM2, FIRM_DEG = 1.0, 25.0, 3.0
"""In the estimate of support: thickness of the wall below a knife edge; section of the column below a part
that tips over when it is tilted by less than an angle; and this angle."""


@dataclass(frozen=True)
class OrientationRules:
    """What restricts the orientation of a part.

    Faces are named by the colour ``#RRGGBB`` that they are painted in, by the name of a marked region, or by the
    direction that they look in as the part was drawn: ``+x``, ``-x``, ``+y``, ``-y``, ``+z`` or ``-z``.

    Attributes
    ----------
    no_contact
        Faces that neither the plate nor a support may touch.
    face_up, face_down
        Faces that must look up or down, to within 45 degrees.
    tilt_deg
        Largest angle by which the part may be tilted from the position in which it was drawn.
    """

    no_contact: tuple[str, ...] = ()
    face_up: tuple[str, ...] = ()
    face_down: tuple[str, ...] = ()
    tilt_deg: float = 180.0

    def __post_init__(self) -> None:
        require_bounds(self, "tilt_deg", at_least=0, at_most=180)
        for name in (*self.no_contact, *self.face_up, *self.face_down):
            require(bool(name), "no_contact, face_up and face_down must name faces", "an empty text")


@dataclass(frozen=True)
class OrientationFigures:
    """What an orientation of a part costs.

    Attributes
    ----------
    height_mm
        Height of the part without its lift.
    box_mm
        Sides of the bounding box; the last one is vertical.
    overhang_mm2
        Area of the faces that need support.
    shadow_mm3
        Volume of the vertical columns between these faces and the plate.
    edges_mm, tips
        Length of the knife edges and number of the tips that need support.
    hold_mm3
        Volume of what must hold a part that does not stand by itself on the plate: a column of 25 mm2 up to its centre
        of mass; else 0.
    estimate
        Estimate of support, which compares orientations: columns below overhangs, walls 1 mm thick below knife edges,
        and what must hold the part; their area in plan (mm2) times their mean height (mm) to the power of 0.6.
    contact_mm2
        Area of the faces on the plate, or at the lift above it.
    tipping_deg
        Angle by which the part must be tilted until it tips over; 0 if it does not stand by itself.
    support_mm3
        Volume of the supports as they were planned; None if they were not.
    unsupported
        Number of regions that stay unsupported then.
    """

    height_mm: float
    box_mm: tuple[float, float, float]
    overhang_mm2: float
    shadow_mm3: float
    edges_mm: float
    tips: int
    hold_mm3: float
    estimate: float
    contact_mm2: float
    tipping_deg: float
    support_mm3: float | None = None
    unsupported: int = 0

    @property
    def box_mm3(self) -> float:
        """Volume of the bounding box."""
        x, y, z = self.box_mm
        return x * y * z


@dataclass(frozen=True, eq=False)
class OrientationProposal:
    """An orientation of a part, with its figures.

    Attributes
    ----------
    rotation
        ``(3, 3)``, part coordinates to build coordinates.
    figures
        What it costs.
    merits
        By what it is the best proposal: ``support``, ``overhang``, ``box``, ``height``, ``stability``, ``balance``.
    """

    rotation: Floats
    figures: OrientationFigures
    merits: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "rotation", frozen(self.rotation, np.float64).reshape(3, 3))

    @property
    def tilt_deg(self) -> float:
        """Angle between the vertical as drawn and as proposed."""
        return float(np.degrees(np.arccos(np.clip(self.rotation[2, 2], -1.0, 1.0))))
