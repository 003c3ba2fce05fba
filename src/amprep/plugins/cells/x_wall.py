"""X-shaped walls that meet their neighbours only every n-th layer (thesis 3.5, figures 1 and 2)."""

from dataclasses import dataclass

import numpy as np

from amprep.errors import JobError
from amprep.model import CellRequest, Cells, Report, Role, Stop
from amprep.plugins.cells.x_shapes import solid_x, surface_x

HAIR = 1e-3
"""Share of the square: how much thinner oblique cells are half way up, times the number of their direction.

So no two cells of different directions have sides in a common plane. Uniting such cells is where manifold3d
leaves triangles folded onto one another.
"""

_USUAL = 0.3
"""mm; what a fine scan track with its neighbour is wide, and what powder still runs through."""


@dataclass(frozen=True)
class XWallParams:
    """How thick the walls are and where they meet.

    Attributes
    ----------
    wall_mm
        Thickness of the walls; 0 makes surfaces, which only targets with walls of no thickness can read. Left
        out, it is 0.3 mm, or a quarter of the pitch if that is less.
    join_every
        Neighbours meet in every n-th layer from the plate; 1 joins them all the way up.
    gap_mm
        How far neighbouring walls are apart where they do not meet. Left out, it is 0.3 mm, or a quarter of the
        pitch if that is less.
    """

    wall_mm: float | None = None
    join_every: int = 3
    gap_mm: float | None = None

    def __post_init__(self) -> None:
        if self.wall_mm is not None and not 0.0 <= self.wall_mm < np.inf:
            raise ValueError(f"wall_mm must be 0 or more, got {self.wall_mm}")
        if self.join_every < 1:
            raise ValueError(f"join_every must be at least 1, got {self.join_every}")
        if self.gap_mm is not None and not 0.0 < self.gap_mm < np.inf:
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
        raise JobError(
            "x-wall: wall_mm = 0 makes walls without thickness, which this target cannot read; set wall_mm"
        )
    lower = request.plane - 1
    low = np.where(_is_joined(lower, params.join_every), 0.0, shares.inset)
    high = np.where(_is_joined(request.plane, params.join_every), 0.0, shares.inset)
    waist = np.where(
        lower % params.join_every == params.join_every - 1,
        0.0,
        np.where(low == high, shares.inset, (low + high) / 2),
    )
    whole = request.role == Role.CONNECTOR
    low[whole], waist[whole], high[whole] = 0.0, 0.0, 0.0
    rows = np.column_stack([low, waist, high])
    if params.wall_mm == 0.0:
        kinds, template = np.unique(rows, axis=0, return_inverse=True)
        templates = tuple(surface_x(*insets) for insets in kinds.tolist())
    else:
        rows = np.column_stack([rows, HAIR * request.direction])
        kinds, template = np.unique(rows, axis=0, return_inverse=True)
        templates = tuple(solid_x(shares.arm, *kind) for kind in kinds.tolist())
    return Cells(templates, template.ravel(), np.arange(len(request.plane)), request.matrices)


def x_wall_material(pitch: float, step: float, params: XWallParams) -> tuple[float, float]:
    """Volume in mm3 of an upright and of an oblique edge, on average over the layers (and the directions).

    The X with arms of half width a in a square with side q = 1 - 2 inset covers 4 a (q - a) of the unit
    square. Between two sections both change linearly; shearing keeps the volume.
    """
    shares = _shares(pitch, params)
    if params.wall_mm == 0.0:
        return 0.0, 0.0
    full, back = 0.0, shares.inset
    n = params.join_every
    layers = [(full, full, full)]
    if n == 2:
        layers.append((full, back, full))
    elif n > 2:
        layers += [(full, back / 2, back), (back, back / 2, full)] + [(back, back, back)] * (n - 3)
    upright = _mean_volume(shares.arm, layers, 0.0)
    oblique = np.mean([_mean_volume(shares.arm, layers, HAIR * direction) for direction in range(1, 5)])
    return upright * pitch * pitch * step, float(oblique) * pitch * pitch * step


def _mean_volume(arm: float, layers: list[tuple[float, float, float]], hair: float) -> float:
    """Mean share of the prism that the X of each layer fills."""
    total = 0.0
    for low, waist, high in layers:
        areas = [
            4.0 * a * (1.0 - 2.0 * inset - a)
            for a, inset in ((arm, low), (arm - hair, waist + hair), (arm, high))
        ]
        middles = [
            4.0 * (arm - hair / 2) * (1.0 - (end + waist + hair) - (arm - hair / 2)) for end in (low, high)
        ]
        total += (areas[0] + 4 * middles[0] + 2 * areas[1] + 4 * middles[1] + areas[2]) / 12.0
    return total / len(layers)


def _is_joined(plane: np.ndarray, every: int) -> np.ndarray:
    """Whether the layer above or below a plane is one in which neighbours meet: the n-th from the plate on.

    The lowest layers stay apart, so that powder which the connectors close in from above leaves below.
    """
    return np.asarray((plane % every == every - 1) | ((plane % every == 0) & (plane > 0)))


def _shares(pitch: float, params: XWallParams) -> _Shares:
    """Turn millimetres into shares of the pitch."""
    usual = min(_USUAL, pitch / 4.0)
    wall = usual if params.wall_mm is None else params.wall_mm
    gap = usual if params.gap_mm is None else params.gap_mm
    shares = _Shares(wall / np.sqrt(2.0) / pitch, 0.5 * gap / pitch)
    if shares.arm + shares.inset >= 0.45:
        needed = (wall * np.sqrt(2.0) + gap) / 0.9
        raise JobError(
            f"x-wall: walls of {wall:g} mm with gaps of {gap:g} mm need a pitch of more than {needed:.3g} mm, "
            f"the grid has {pitch:.4g}; make wall_mm or gap_mm smaller or pitch_mm larger"
        )
    return shares
