"""The cells ``strut`` and ``bcc``: a pin along each edge, and the body-centred cubic cell, both declared as graphs."""

from dataclasses import dataclass

import numpy as np

from amprep.errors import JobError
from amprep.model import DeclaredCell, GraphCell, Variant, When
from amprep.validation import require_bounds

_CORNERS = [[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
_CENTRE = 8
_UPRIGHT = [[0, 4], [1, 5], [2, 6], [3, 7]]
"""The four vertical edges of the cube."""


@dataclass(frozen=True)
class StrutParams:
    """Parameters of the cell ``strut``.

    Attributes
    ----------
    diameter_mm
        Diameter of pins and ties. The default is 0.8 mm, but at most a quarter of the pitch.
    tie_every
        In every n-th layer, four ties connect an upright pin to its neighbours; 0 for no ties.
    solid
        Whether struts become solids instead of beams.
    """

    diameter_mm: float | None = None
    tie_every: int = 3
    solid: bool = True

    def __post_init__(self) -> None:
        require_bounds(self, "diameter_mm", above=0, below=np.inf)
        require_bounds(self, "tie_every", at_least=0)


@dataclass(frozen=True)
class BccParams:
    """Parameters of the cell ``bcc``.

    Attributes
    ----------
    diameter_mm
        Diameter of the struts. The default is 0.8 mm, but at most a quarter of the pitch.
    solid
        Whether struts become solids instead of beams.
    """

    diameter_mm: float | None = None
    solid: bool = True

    def __post_init__(self) -> None:
        require_bounds(self, "diameter_mm", above=0, below=np.inf)


def declare_strut(pitch: float, step: float, params: StrutParams) -> DeclaredCell:  # noqa: ARG001
    """Return a pin between the centres of both squares, with ties between upright pins.

    A tie runs from the lower end of the pin to the middle of a side of the upper square, where it meets the tie of the
    neighbour. It is steeper than the oblique pins of the same grid.
    """
    radius = _radius("strut", pitch, params.diameter_mm)
    points = [[0.5, 0.5, 0], [0.5, 0.5, 1], [0, 0.5, 1], [1, 0.5, 1], [0.5, 0, 1], [0.5, 1, 1]]
    pin = Variant(GraphCell(np.array(points[:2]), np.array([[0, 1]]), radius))
    if params.tie_every == 0:
        return DeclaredCell((pin,))
    tied = GraphCell(np.array(points), np.array([[0, end] for end in range(1, 6)]), radius)
    when = When(
        roles=frozenset({"trunk", "foot"}),
        edges="straight",
        every=params.tie_every,
        layer=params.tie_every - 1,
    )
    return DeclaredCell((Variant(tied, when), pin))


def declare_bcc(pitch: float, step: float, params: BccParams) -> DeclaredCell:  # noqa: ARG001
    """Return the cell whose struts join its centre to its corners; oblique edges get struts between corners.

    If the cell itself were sheared, four of its eight struts would be too flat to be printed.
    """
    radius = _radius("bcc", pitch, params.diameter_mm)
    corners = np.array(_CORNERS)
    diagonals = np.array([[corner, _CENTRE] for corner in range(8)])
    centred = GraphCell(np.vstack([corners, [0.5, 0.5, 0.5]]), diagonals, radius)
    oblique = GraphCell(corners, np.array(_UPRIGHT), radius)
    return DeclaredCell((Variant(centred, When(edges="straight")), Variant(oblique)))


def _radius(name: str, pitch: float, diameter: float | None) -> float:
    wanted = min(0.8, pitch / 4.0) if diameter is None else diameter
    if wanted > pitch / 2.0:
        raise JobError(
            f"{name}: struts of {wanted:g} mm need a pitch of at least {2.0 * wanted:.3g} mm, "
            f"the grid has {pitch:.4g}; reduce diameter_mm or increase pitch_mm"
        )
    return wanted / 2.0
