"""Block supports as machine software makes them: a grid of thin walls with windows, teeth and gaps."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Bools
from amprep.errors import JobError
from amprep.model import CellRequest, Cells, Progress, Role, Stop
from amprep.model.supports.edges import square_keys
from amprep.plugins.cells.hatch.shapes import Walls, hatch_template

HAIR = 1e-3
"""Share of the pitch: how much thinner walls of oblique edges are, times the number of their direction.

So no two cells of different directions have sides in a common plane, which unions do badly.
"""

_ROOF_DEG = 55.0
"""Steepness of the upper sides of the windows."""


@dataclass(frozen=True)
class HatchParams:
    """Words and lengths as in the block supports of machine software.

    Attributes
    ----------
    hatch_mm
        Distance of parallel walls; rounded so that a whole number of them fits the pitch. Left out, it is half of
        the pitch.
    wall_mm
        Thickness of the walls.
    window_mm
        Width of the diamond-shaped openings in the walls of straight edges, through which powder leaves; 0: none.
    tooth_pitch_mm, tooth_width_mm, tooth_height_mm
        Teeth along the top of the walls: their distance (left out, that of the walls; 0: none), their width
        where they meet the part, and how far down the notches between them reach below the support's end.
    fragment_every, fragment_gap_mm
        Every n-th cell begins a new block, the walls interrupted by the gap; 0: one block.
    """

    hatch_mm: float | None = None
    wall_mm: float = 0.25
    window_mm: float = 0.5
    tooth_pitch_mm: float | None = None
    tooth_width_mm: float = 0.5
    tooth_height_mm: float = 0.8
    fragment_every: int = 6
    fragment_gap_mm: float = 0.2

    def __post_init__(self) -> None:
        for name in ("hatch_mm", "wall_mm", "tooth_width_mm", "tooth_height_mm", "fragment_gap_mm"):
            _require(name, getattr(self, name), above=True)
        for name in ("window_mm", "tooth_pitch_mm", "fragment_every"):
            _require(name, getattr(self, name), above=False)
        if self.tooth_pitch_mm and self.tooth_width_mm > self.tooth_pitch_mm:
            raise ValueError(f"tooth_width_mm is at most tooth_pitch_mm, got {self.tooth_width_mm}")


def _require(name: str, value: float | None, *, above: bool) -> None:
    if value is not None and not (0.0 < value < np.inf or (value == 0.0 and not above)):
        raise ValueError(f"{name} must be {'more than 0' if above else '0 or more'}, got {value}")


def emit_hatch(request: CellRequest, *, params: HatchParams, stop: Stop, progress: Progress) -> Cells:  # noqa: ARG001
    """Put the walls under the map of each edge.

    Ends of supports have teeth; connector edges are teeth all the way up, so that the part is met by teeth alone.
    """
    pitch, step = request.frame.pitch, request.frame.step
    straight = request.edges.direction == 0
    starts = straight & (request.role != Role.CONNECTOR)
    every = params.fragment_every or 1
    cut = [
        starts & (place % every == 0) & bool(params.fragment_every)
        for place in (request.edges.x, request.edges.y)
    ]
    end = np.where(request.role == Role.CONNECTOR, 2, _is_end(request)) * (params.tooth_pitch_mm != 0.0)
    rows = np.column_stack([request.edges.direction, end, *cut]).astype(np.int64)
    kinds, template = np.unique(rows, axis=0, return_inverse=True)
    templates = tuple(hatch_template(_walls(pitch, step, params, *kind)) for kind in kinds.tolist())
    return Cells(templates, template.ravel(), np.arange(len(request.edges)), request.matrices)


def hatch_material(pitch: float, step: float, params: HatchParams) -> tuple[float, float]:
    """Return the mm3 of an upright and of an oblique edge, without teeth and gaps."""
    shares = [
        hatch_template(_walls(pitch, step, params, direction, 0, 0, 0)).mesh.signed_volume
        for direction in (0, 1)
    ]
    return shares[0] * pitch * pitch * step, shares[1] * pitch * pitch * step


def _walls(
    pitch: float, step: float, params: HatchParams, direction: int, end: int, cut_x: int, cut_y: int
) -> Walls:
    """Turn millimetres into shares.

    Parameters
    ----------
    end
        1: the support ends here, 2: it is a connector.
    cut_x, cut_y
        Whether a new block begins here.
    """
    count = max(1, round(pitch / (params.hatch_mm or pitch / 2.0)))
    thickness = params.wall_mm / pitch - HAIR * direction
    span = 1.0 / count - params.wall_mm / pitch
    if span < 0.1 / count or thickness <= 0.0:
        raise JobError(
            f"hatch: walls of {params.wall_mm:g} mm every {pitch / count:.3g} mm leave no room, or are too thin "
            f"for a pitch of {pitch:.4g} mm; change wall_mm, hatch_mm or pitch_mm"
        )
    gap = params.fragment_gap_mm / pitch
    if params.fragment_every and gap > span / 2.0:
        raise JobError(
            f"hatch: fragment_gap_mm = {params.fragment_gap_mm:g} does not fit between the side of a cell and "
            f"its first wall, {span / 2.0 * pitch:.3g} mm"
        )
    window = (0.0, 0.0) if direction else _window(pitch, step, params, span)
    teeth = max(1, round(pitch / (params.tooth_pitch_mm or pitch / count))) if end else 0
    tooth = min(params.tooth_width_mm / pitch, 0.95 / teeth) if teeth else 0.0
    root = 1.0 if end == 2 else min(params.tooth_height_mm / step, 0.9)
    return Walls(
        count, thickness, window if end != 2 else (0.0, 0.0), teeth, tooth, root, (gap * cut_x, gap * cut_y)
    )


def _window(pitch: float, step: float, params: HatchParams, span: float) -> tuple[float, float]:
    """Return width and height of the windows: at most four fifths of the span, and half of the step."""
    slope = float(np.tan(np.radians(_ROOF_DEG)))
    width = min(params.window_mm, 0.8 * span * pitch, 0.5 * step / slope)
    return width / pitch, width * slope / step


def _is_end(request: CellRequest) -> Bools:
    """Tell at which edges supports end: no other edge of theirs leads down to the upper square."""
    trunk = request.role != Role.CONNECTOR
    upper, lower = square_keys(request.edges.upper), square_keys(request.edges.lower)
    return np.asarray(trunk & ~np.isin(upper, lower[trunk]))
