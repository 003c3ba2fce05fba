"""Block supports: a grid of thin walls with perforations, teeth and fragmentation gaps."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools
from amprep.errors import JobError
from amprep.model import CellRequest, Cells, Progress, Role, Stop
from amprep.model.supports.edges import square_keys
from amprep.plugins.cells.hatch.shapes import HatchWalls, hatch_template
from amprep.validation import require, require_bounds

THINNING = 1e-3
"""Fraction of the pitch by which walls of oblique edges are thinner, times the number of their direction.

Cells of different directions therefore have no sides in a common plane, for which Boolean unions are unreliable.
"""

_DEFAULT_WALL = 0.25
"""Default thickness of walls (mm)."""

_LEAST_SPAN = 0.1
"""Least distance between the sides of two walls, as a fraction of the distance of their middles."""

_ROOF_DEG = 55.0
"""Angle of the upper sides of perforations to the horizontal."""


@dataclass(frozen=True)
class HatchParams:
    """Parameters of the cell ``hatch``, named as in the block supports of machine software.

    Attributes
    ----------
    hatch_mm
        Distance between parallel walls, rounded to a whole number of walls per pitch. The default is half the pitch, or
        the pitch where two walls leave no room for gaps.
    wall_mm
        Thickness of the walls. The default is 0.25 mm, or the least wall of the job if that is more.
    perforation_mm
        Width of the diamond-shaped openings in walls of straight edges, through which powder escapes; 0 for none.
    tooth_pitch_mm, tooth_width_mm, tooth_height_mm
        Teeth along the top of the walls: their distance (the default is that of the walls, 0 for no teeth), their
        width at the part, and the depth of the notches between them below the end of the support.
    fragment_every, fragment_gap_mm
        A new block begins at every n-th cell, and a gap interrupts the walls there; 0 for one block.
    """

    hatch_mm: float | None = None
    wall_mm: float | None = None
    perforation_mm: float = 0.5
    tooth_pitch_mm: float | None = None
    tooth_width_mm: float = 0.5
    tooth_height_mm: float = 0.8
    fragment_every: int = 6
    fragment_gap_mm: float = 0.2

    def __post_init__(self) -> None:
        sizes = ("hatch_mm", "wall_mm", "tooth_width_mm", "tooth_height_mm", "fragment_gap_mm")
        require_bounds(self, *sizes, above=0, below=np.inf)
        require_bounds(self, "perforation_mm", "tooth_pitch_mm", "fragment_every", at_least=0, below=np.inf)
        fits = not self.tooth_pitch_mm or self.tooth_width_mm <= self.tooth_pitch_mm
        require(fits, "tooth_width_mm must be at most tooth_pitch_mm", self.tooth_width_mm)


def emit_hatch(request: CellRequest, *, params: HatchParams, stop: Stop, progress: Progress) -> Cells:  # noqa: ARG001
    """Put the walls under the map of each edge.

    Walls end in teeth where a support ends. Connector edges consist of teeth alone, so that only teeth touch the part.
    """
    pitch, step = request.grid.pitch, request.grid.step
    spacing = _spacing(pitch, params, request.least_wall)
    edges, is_connector = request.edges, request.role == Role.CONNECTOR
    fragmented = (edges.direction == 0) & ~is_connector & bool(params.fragment_every)
    every = params.fragment_every or 1
    cut = [fragmented & (place % every == 0) for place in (edges.x, edges.y)]
    end = np.where(is_connector, 2, _is_end(request)) * (params.tooth_pitch_mm != 0.0)
    rows = np.column_stack([edges.direction, end, *cut]).astype(np.int64)
    kinds, template = np.unique(rows, axis=0, return_inverse=True)
    templates = tuple(hatch_template(_walls(pitch, step, params, spacing, *kind)) for kind in kinds.tolist())
    return Cells(templates, template.ravel(), np.arange(len(edges)), request.matrices)


def hatch_material(pitch: float, step: float, params: HatchParams) -> tuple[float, float]:
    """Estimate the volume (mm3) of an upright and of an oblique edge, without teeth and gaps."""
    spacing = _spacing(pitch, params)
    upright, oblique = (
        hatch_template(_walls(pitch, step, params, spacing, direction, 0, 0, 0)).mesh.signed_volume
        for direction in (0, 1)
    )
    return upright * pitch * pitch * step, oblique * pitch * pitch * step


class _Spacing(NamedTuple):
    """Thickness of the walls (mm), and their number in each of the two directions."""

    wall: float
    number: int


def _spacing(pitch: float, params: HatchParams, least_wall: float = 0.0) -> _Spacing:
    """Return the walls that the user states; else walls as thick as the least wall, two if there is room for gaps."""
    wall = max(_DEFAULT_WALL, least_wall) if params.wall_mm is None else params.wall_mm
    if params.hatch_mm is not None:
        return _Spacing(wall, max(1, round(pitch / params.hatch_mm)))
    gap = 2.0 * params.fragment_gap_mm if params.fragment_every else _LEAST_SPAN * pitch / 2.0
    return _Spacing(wall, 2 if pitch / 2.0 - wall >= gap else 1)


def _walls(
    pitch: float,
    step: float,
    params: HatchParams,
    spacing: _Spacing,
    direction: int,
    end: int,
    cut_x: int,
    cut_y: int,
) -> HatchWalls:
    """Convert lengths to fractions of the unit cube.

    Parameters
    ----------
    pitch, step
        Width and height (mm) of a voxel.
    spacing
        Thickness and number of the walls.
    direction
        Index into `amprep.model.DIRECTIONS`.
    end
        1 where the support ends, 2 for a connector, else 0.
    cut_x, cut_y
        1 where a new block begins in this direction, else 0.
    """
    count = spacing.number
    thickness = spacing.wall / pitch - THINNING * direction
    span = 1.0 / count - spacing.wall / pitch
    gap = params.fragment_gap_mm / pitch
    _require_room(pitch, params, spacing, thickness, span)
    perforated = not direction and end != 2
    teeth = max(1, round(pitch / (params.tooth_pitch_mm or pitch / count))) if end else 0
    return HatchWalls(
        count,
        thickness,
        _perforation(pitch, step, params, span) if perforated else (0.0, 0.0),
        teeth,
        min(params.tooth_width_mm / pitch, 0.95 / teeth) if teeth else 0.0,
        1.0 if end == 2 else min(params.tooth_height_mm / step, 0.9),
        (gap * cut_x, gap * cut_y),
    )


def _require_room(
    pitch: float, params: HatchParams, spacing: _Spacing, thickness: float, span: float
) -> None:
    if span < _LEAST_SPAN / spacing.number or thickness <= 0.0:
        raise JobError(
            f"hatch: walls of {spacing.wall:g} mm every {pitch / spacing.number:.3g} mm leave no room, or are too thin "
            f"for a pitch of {pitch:.4g} mm; change wall_mm, hatch_mm or pitch_mm"
        )
    if params.fragment_every and params.fragment_gap_mm / pitch > span / 2.0:
        raise JobError(
            f"hatch: fragment_gap_mm = {params.fragment_gap_mm:g} does not fit between the side of a cell and "
            f"its first wall, {span / 2.0 * pitch:.3g} mm; reduce fragment_gap_mm or wall_mm"
        )


def _perforation(pitch: float, step: float, params: HatchParams, span: float) -> tuple[float, float]:
    """Return width and height of the perforations: at most four fifths of the span, and half of the step."""
    slope = float(np.tan(np.radians(_ROOF_DEG)))
    width = min(params.perforation_mm, 0.8 * span * pitch, 0.5 * step / slope)
    return width / pitch, width * slope / step


def _is_end(request: CellRequest) -> Bools:
    """Tell at which edges a support ends: no other edge of the support begins above the upper square."""
    trunk = request.role != Role.CONNECTOR
    upper, lower = square_keys(request.edges.upper), square_keys(request.edges.lower)
    return np.asarray(trunk & ~np.isin(upper, lower[trunk]))
