"""The cells ``strut`` and ``bcc``: a pin along each edge, and the body-centred cubic cell, both declared as graphs."""

from dataclasses import dataclass, replace

import numpy as np

from amprep.errors import JobError
from amprep.model import CellRequest, DeclaredCell, GraphCell, Variant, When
from amprep.validation import require_bounds

_CORNERS = [[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
_CENTRE = 8
_UPRIGHT = [[0, 4], [1, 5], [2, 6], [3, 7]]
"""The four vertical edges of the cube."""

_APEX, _APEX_HEIGHT = 8, 0.9
"""Point above the lower corners of an oblique cell in which four struts meet, and its height. Sheared by a step of 45
degrees, the flattest of them is at 31 degrees to the plate."""

_ROUND = 1.06
"""Diameter of a strut in diameters of the largest disc that fits in its section, which is a polygon."""

_CORNER = 1.34
"""The same in the corner of a lone cell, of whose struts and ball a quarter is inside the cell."""

_WIDER, _WIDEST = 2.0, 0.35
"""Radius of the struts along the corners of an oblique cell, of which only a quarter is inside the cell: in radii of
the other struts, but at most this fraction of the pitch."""


@dataclass(frozen=True)
class StrutParams:
    """Parameters of the cell ``strut``.

    Attributes
    ----------
    diameter_mm
        Diameter of pins and ties. The default is 0.8 mm, but at most a quarter of the pitch; the limits of a job may
        require more, see `fit_strut`.
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
        Diameter of the struts. The default is 0.8 mm, but at most a quarter of the pitch; the limits of a job may
        require more, see `fit_bcc`.
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

    If the cell itself were sheared, four of its eight struts would be too flat to be printed. Four further struts lead
    from the lower corners of an oblique cell to a point near the middle of its upper side, so that the struts
    between corners brace one another in each layer. Those are wider, because a quarter of each is inside the cell.
    """
    radius = _radius("bcc", pitch, params.diameter_mm)
    corners = np.array(_CORNERS)
    diagonals = np.array([[corner, _CENTRE] for corner in range(8)])
    centred = GraphCell(np.vstack([corners, [0.5, 0.5, 0.5]]), diagonals, radius)
    braces = [[corner, _APEX] for corner in range(4)]
    wider = max(radius, min(_WIDER * radius, _WIDEST * pitch))
    oblique = GraphCell(
        np.vstack([corners, [0.5, 0.5, _APEX_HEIGHT]]),
        np.array([*_UPRIGHT, *braces]),
        np.repeat([wider, radius], 4),
    )
    return DeclaredCell((Variant(centred, When(edges="straight")), Variant(oblique)))


def fit_strut(params: StrutParams, request: CellRequest) -> StrutParams:
    """Return parameters with a diameter for the least wall, and for the length of pins between their ties."""
    between = params.tie_every * request.grid.step / request.leg_ratio if request.leg_ratio else 0.0
    least = max(_ROUND * request.least_wall, between)
    return replace(params, diameter_mm=_at_least(least, request.grid.pitch, params.diameter_mm))


def fit_bcc(params: BccParams, request: CellRequest) -> BccParams:
    """Return parameters with a diameter for the least wall in the corners of a lone cell."""
    least = _CORNER * request.least_wall
    return replace(params, diameter_mm=_at_least(least, request.grid.pitch, params.diameter_mm))


def _at_least(least: float, pitch: float, diameter: float | None) -> float:
    """Return a diameter that the user states, or the usual one or more, up to half of the pitch."""
    return min(max(_usual(pitch), least), pitch / 2.0) if diameter is None else diameter


def _usual(pitch: float) -> float:
    return min(0.8, pitch / 4.0)


def _radius(name: str, pitch: float, diameter: float | None) -> float:
    wanted = _usual(pitch) if diameter is None else diameter
    if wanted > pitch / 2.0:
        raise JobError(
            f"{name}: struts of {wanted:g} mm need a pitch of at least {2.0 * wanted:.3g} mm, "
            f"the grid has {pitch:.4g}; reduce diameter_mm or increase pitch_mm"
        )
    return wanted / 2.0
