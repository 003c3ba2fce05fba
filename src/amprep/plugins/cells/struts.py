"""Two lattices of round struts, declared as graphs: a pin along every edge, and the body-centred cubic cell."""

from dataclasses import dataclass

import numpy as np

from amprep.errors import JobError
from amprep.model import DeclaredCell, GraphCell, Variant, When

_CORNERS = [[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
_CENTRE = 8
_UPRIGHT = [[0, 4], [1, 5], [2, 6], [3, 7]]
"""The four edges of the cube along the way of the support."""


@dataclass(frozen=True)
class StrutParams:
    """How thick the pins are, and where they hold one another.

    Attributes
    ----------
    diameter_mm
        Of pins and ties. Left out, it is 0.8 mm, or a quarter of the pitch if that is less.
    tie_every
        In every n-th layer upright pins lean four ties on their neighbours; 0: never.
    solid
        Struts as solids; false: as beams.
    """

    diameter_mm: float | None = None
    tie_every: int = 3
    solid: bool = True

    def __post_init__(self) -> None:
        _require_diameter(self.diameter_mm)
        if self.tie_every < 0:
            raise ValueError(f"tie_every must be 0 or more, got {self.tie_every}")


@dataclass(frozen=True)
class BccParams:
    """How thick the struts of the body-centred cubic cell are.

    Attributes
    ----------
    diameter_mm
        Left out, it is 0.8 mm, or a quarter of the pitch if that is less.
    solid
        Struts as solids; false: as beams.
    """

    diameter_mm: float | None = None
    solid: bool = True

    def __post_init__(self) -> None:
        _require_diameter(self.diameter_mm)


def declare_strut(pitch: float, step: float, params: StrutParams) -> DeclaredCell:  # noqa: ARG001
    """Return a pin from the middle of the upper square to that of the lower one, with ties between upright ones.

    A tie runs from the foot of the pin to the middle of an edge of the upper square, where the neighbour's
    meets it: steeper than the oblique pins of the same grid.
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
    """Return the cell whose struts join its centre to its corners; oblique edges get struts from corner to corner.

    Sheared, four of the eight struts would lie too flat to be printed.
    """
    radius = _radius("bcc", pitch, params.diameter_mm)
    corners = np.array(_CORNERS)
    diagonals = np.array([[corner, _CENTRE] for corner in range(8)])
    centred = GraphCell(np.vstack([corners, [0.5, 0.5, 0.5]]), diagonals, radius)
    oblique = GraphCell(corners, np.array(_UPRIGHT), radius)
    return DeclaredCell((Variant(centred, When(edges="straight")), Variant(oblique)))


def _require_diameter(diameter: float | None) -> None:
    if diameter is not None and not 0.0 < diameter < np.inf:
        raise ValueError(f"diameter_mm must be more than 0, got {diameter}")


def _radius(name: str, pitch: float, diameter: float | None) -> float:
    wanted = min(0.8, pitch / 4.0) if diameter is None else diameter
    if wanted > pitch / 2.0:
        raise JobError(
            f"{name}: struts of {wanted:g} mm need a pitch of at least {2.0 * wanted:.3g} mm, "
            f"the grid has {pitch:.4g}; make diameter_mm smaller or pitch_mm larger"
        )
    return wanted / 2.0
