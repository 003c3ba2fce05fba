"""X-shaped walls that meet their neighbours only every n-th layer (thesis 3.5, figures 1 and 2)."""

from dataclasses import dataclass

import numpy as np

from amprep.errors import JobError
from amprep.model import CellRequest, Cells, Report, Role, Stop
from amprep.plugins.cells.x_shapes import solid_x, surface_x


@dataclass(frozen=True)
class XWallParams:
    """How thick the walls are and where they meet.

    Attributes
    ----------
    wall_mm
        Thickness of the walls; 0 makes surfaces, which only targets with walls of no thickness can read.
    join_every
        Neighbours meet in every n-th layer, the one on the plate first; 1 joins them all the way up.
    gap_mm
        How far neighbouring walls are apart where they do not meet.
    """

    wall_mm: float = 0.3
    join_every: int = 3
    gap_mm: float = 0.3

    def __post_init__(self) -> None:
        if not 0.0 <= self.wall_mm < np.inf:
            raise ValueError(f"wall_mm must be 0 or more, got {self.wall_mm}")
        if self.join_every < 1:
            raise ValueError(f"join_every must be at least 1, got {self.join_every}")
        if not 0.0 < self.gap_mm < np.inf:
            raise ValueError(f"gap_mm must be more than 0, got {self.gap_mm}")


@dataclass(frozen=True)
class _Shares:
    """The parameters as shares of the pitch: half of a wall's width along x, and half of a gap."""

    arm: float
    inset: float


def emit_x_walls(request: CellRequest, *, params: XWallParams, stop: Stop, report: Report) -> Cells:  # noqa: ARG001
    """Put an X under the map of each edge; its size at a plane depends on the plane alone.

    At both planes of every `join_every`-th layer the arms reach the sides of the square, at the others they
    are drawn back, with a slope between. A layer between two joined ones has a waist.
    """
    shares = _shares(request.frame.pitch, params)
    if params.wall_mm == 0.0 and not request.allow_surface:
        raise JobError("x-wall: wall_mm = 0 makes walls without thickness, which this target cannot read; set wall_mm")
    lower = request.plane - 1
    low = np.where(_is_joined(lower, params.join_every), 0.0, shares.inset)
    high = np.where(_is_joined(request.plane, params.join_every), 0.0, shares.inset)
    waist = np.where(lower % params.join_every == 0, 0.0, np.where(low == high, shares.inset, (low + high) / 2))
    whole = request.role == Role.CONNECTOR
    low[whole], waist[whole], high[whole] = 0.0, 0.0, 0.0
    kinds, template = np.unique(np.column_stack([low, waist, high]), axis=0, return_inverse=True)
    make = solid_x if params.wall_mm > 0.0 else surface_x
    templates = tuple(make(shares.arm, *insets) for insets in kinds.tolist())
    return Cells(templates, template.ravel(), np.arange(len(request.plane)), request.matrices)


def x_wall_material(pitch: float, step: float, params: XWallParams) -> tuple[float, float]:
    """Volume in mm3 of an edge, on average over the layers; shearing keeps it.

    The X with arms of half width a in a square with side q = 1 - 2 inset covers 4 a (q - a) of the unit
    square, and in each layer the inset changes linearly.
    """
    shares = _shares(pitch, params)
    n = params.join_every
    drawn_back = {1: 0.0, 2: 0.25}.get(n, (n - 2) / n)  # mean inset, as a share of the full one
    side = 1.0 - 2.0 * shares.inset * drawn_back
    volume = 4.0 * shares.arm * (side - shares.arm) * pitch * pitch * step
    return volume, volume


def _is_joined(plane: np.ndarray, every: int) -> np.ndarray:
    """Whether the layer above or below a plane is one in which neighbours meet."""
    return (plane % every == 0) | ((plane - 1) % every == 0)


def _shares(pitch: float, params: XWallParams) -> _Shares:
    """Turn millimetres into shares of the pitch."""
    shares = _Shares(params.wall_mm / np.sqrt(2.0) / pitch, 0.5 * params.gap_mm / pitch)
    if shares.arm + shares.inset >= 0.45:
        needed = (params.wall_mm * np.sqrt(2.0) + params.gap_mm) / 0.9
        raise JobError(
            f"x-wall: walls of {params.wall_mm:g} mm with gaps of {params.gap_mm:g} mm need a pitch of more than "
            f"{needed:.3g} mm, the grid has {pitch:.4g}; make wall_mm or gap_mm smaller or pitch_mm larger"
        )
    return shares
