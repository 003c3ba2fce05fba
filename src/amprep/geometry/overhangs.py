"""What of a mesh needs support: faces, knife edges and downward tips (thesis 3.1)."""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

Kind = Literal["face", "edge", "tip"]


class OverhangRegion(NamedTuple):
    """A connected region that needs support.

    Attributes
    ----------
    kind
        ``face``, ``edge`` or ``tip``.
    measure
        Area in mm2, length in mm, or 0 for a tip.
    centre
        ``(3,)`` mm, weighted by area or length.
    """

    kind: Kind
    measure: float
    centre: Floats


class Overhangs(NamedTuple):
    """Everything of a mesh that needs support, in connected regions.

    Attributes
    ----------
    faces
        ``(f,)`` int32, triangles.
    face_region
        ``(f,)`` int32, index into `regions`; labels of faces come first, then edges, then tips.
    edges
        ``(e, 2)`` int32, vertex indices.
    edge_region
        ``(e,)`` int32.
    tips
        ``(t,)`` int32, vertex indices.
    tip_region
        ``(t,)`` int32.
    """

    faces: Ints
    face_region: Ints
    edges: Ints
    edge_region: Ints
    tips: Ints
    tip_region: Ints
    regions: tuple[OverhangRegion, ...]
