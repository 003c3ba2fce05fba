"""The cell ``x-wall``: X-shaped walls that meet their neighbours only in every n-th layer (thesis 3.5)."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from amprep.errors import JobError
from amprep.model import DIRECTIONS, CellRequest, Cells, Progress, Role, Stop, Template
from amprep.model.supports.edges import square_keys
from amprep.plugins.cells.x_wall.shapes import ArmWindow, Bends, solid_x, surface_x
from amprep.validation import require_bounds

THINNING = 1e-3
"""Fraction of the pitch by which oblique cells are thinner at half their height, times the number of their direction.

Cells of different directions therefore have no sides in a common plane. When manifold3d unites such cells, it leaves
triangles that are folded onto each other.
"""

_DEFAULT_SIZE = 0.3
"""Default thickness of walls and width of gaps (mm): two fine scan tracks, and wide enough for powder."""

_THICKEST = 0.375
"""Largest default thickness of walls, as a fraction of the pitch."""

_HOLE = 0.2
"""Diameter (mm) of the smallest hole through which powder escapes."""

_NEAR_ARMS, _NEAR_CENTRE = 0.7, 0.1
"""Distance of a window to the centre of the cell: in widths of an arm, but at least this fraction of the pitch."""

_SMALLEST_WINDOW = 0.3
"""Smallest width of a window (mm); beside it, the wall is as wide as it is thick."""


@dataclass(frozen=True)
class XWallParams:
    """Parameters of the cell ``x-wall``.

    Attributes
    ----------
    wall_mm
        Thickness of the walls; 0 makes sheets, which only some targets can read. The default is 0.3 mm, or the least
        wall of the job if that is more, but at most 3/8 of the pitch.
    join_every
        Neighbours meet in every n-th layer from the plate; 1 joins them in all layers.
    gap_mm
        Distance of neighbouring walls where they do not meet. The default is 0.3 mm, but at most a quarter of the
        pitch.
    """

    wall_mm: float | None = None
    join_every: int = 3
    gap_mm: float | None = None

    def __post_init__(self) -> None:
        require_bounds(self, "wall_mm", at_least=0, below=np.inf)
        require_bounds(self, "join_every", at_least=1)
        require_bounds(self, "gap_mm", above=0, below=np.inf)


@dataclass(frozen=True)
class _Lengths:
    """Lengths of the X as fractions of the pitch.

    Attributes
    ----------
    arm
        Half of the width of a wall along x.
    inset
        Half of a gap.
    window
        Windows in the arms, or None.
    """

    arm: float
    inset: float
    window: ArmWindow | None = None


def emit_x_walls(request: CellRequest, *, params: XWallParams, stop: Stop, progress: Progress) -> Cells:  # noqa: ARG001
    """Put an X under the map of each edge; its size at a plane of the grid depends only on the plane.

    At both planes of every `join_every`-th layer, the arms reach the sides of the square. At other planes they are
    shorter, and slopes connect both lengths. A layer between two joined layers has a waist. Unless all layers are
    joined, arms have windows where cells cross, through which powder escapes from between their walls.
    """
    lengths = _lengths(request.grid.pitch, params, request.least_wall)
    if params.wall_mm == 0.0 and not request.allow_surface:
        raise JobError(
            "x-wall: wall_mm = 0 makes walls without thickness, which this target cannot read; set wall_mm above 0"
        )
    rows = _insets(request.edges.plane, params.join_every, lengths.inset)
    rows[request.role == Role.CONNECTOR] = 0.0
    thinning = np.where(params.wall_mm == 0.0, 0.0, THINNING * request.edges.direction)
    rows = np.column_stack([rows, thinning, _beside_oblique(request)])
    kinds, template = np.unique(rows, axis=0, return_inverse=True)
    templates = tuple(_template(lengths, kind[:3], kind[3], bool(kind[4])) for kind in kinds.tolist())
    edge = np.arange(len(request.edges))
    hole = _HOLE if params.join_every > 1 and params.wall_mm != 0.0 else 0.0
    return Cells(templates, template.ravel(), edge, request.matrices, hole=hole)


def _beside_oblique(request: CellRequest) -> NDArray[np.bool_]:
    """Tell which edges are oblique or share a square with an oblique edge, so that their walls cross."""
    edges, oblique = request.edges, request.edges.direction > 0
    found = oblique.copy()
    for square in (square_keys(edges.upper), square_keys(edges.lower)):
        found |= np.isin(square, square[oblique])
    return np.asarray(found & (request.role != Role.CONNECTOR))


def _insets(plane: NDArray[np.integer], every: int, inset: float) -> NDArray[np.float64]:
    """Return the insets of the arms in the layer below each plane: at the bottom, at half the height and at the top."""
    lower = plane - 1
    low, high = (np.where(_is_joined(each, every), 0.0, inset) for each in (lower, plane))
    between = np.where(low == high, inset, (low + high) / 2)
    return np.column_stack([low, np.where(lower % every == every - 1, 0.0, between), high])


def _template(lengths: _Lengths, insets: list[float], thinning: float, pierced: bool) -> Template:
    """Return an X with the insets of `_insets`, and with windows if it is `pierced`."""
    bends = Bends(*insets)
    window = lengths.window if pierced else None
    if lengths.arm == 0.0:
        return surface_x(bends, window)
    return solid_x(lengths.arm, bends, thinning, window)


def x_wall_material(pitch: float, step: float, params: XWallParams) -> tuple[float, float]:
    """Estimate the volume (mm3) of an upright and of an oblique edge, averaged over the layers and the directions.

    Windows are ignored. They remove the same volume from an upright edge beside an oblique edge, so a router that
    saves material should not prefer oblique edges because of them.
    """
    lengths = _lengths(pitch, params)
    if params.wall_mm == 0.0:
        return 0.0, 0.0
    layers = _insets(params.join_every * 2 + np.arange(params.join_every), params.join_every, lengths.inset)
    upright, *oblique = (_mean_volume(lengths, layers, direction) for direction in range(len(DIRECTIONS)))
    return upright * pitch * pitch * step, float(np.mean(oblique)) * pitch * pitch * step


def _mean_volume(lengths: _Lengths, layers: NDArray[np.float64], direction: int) -> float:
    """Return the mean fraction of the prism that the X of each layer fills."""
    templates = [_template(lengths, layer, THINNING * direction, pierced=False) for layer in layers.tolist()]
    return float(np.mean([template.mesh.signed_volume for template in templates]))


def _is_joined(plane: np.ndarray, every: int) -> np.ndarray:
    """Tell whether neighbours meet in the layer above or below a plane, which is every n-th layer from the plate.

    Neighbours do not meet in the lowest layers, so that powder below the connectors escapes there.
    """
    return np.asarray((plane % every == every - 1) | ((plane % every == 0) & (plane > 0)))


def _lengths(pitch: float, params: XWallParams, least_wall: float = 0.0) -> _Lengths:
    """Convert millimetres to fractions of the pitch."""
    default = min(max(_DEFAULT_SIZE, least_wall), _THICKEST * pitch)
    wall = default if params.wall_mm is None else params.wall_mm
    gap = min(_DEFAULT_SIZE, pitch / 4.0) if params.gap_mm is None else params.gap_mm
    lengths = _Lengths(wall / np.sqrt(2.0) / pitch, 0.5 * gap / pitch)
    if lengths.arm + lengths.inset >= 0.45:
        needed = (wall * np.sqrt(2.0) + gap) / 0.9
        raise JobError(
            f"x-wall: walls of {wall:g} mm with gaps of {gap:g} mm need a pitch of more than {needed:.3g} mm, "
            f"the grid has {pitch:.4g}; reduce wall_mm or gap_mm or increase pitch_mm"
        )
    return replace(lengths, window=_window(pitch, wall, lengths)) if params.join_every > 1 else lengths


def _window(pitch: float, wall: float, lengths: _Lengths) -> ArmWindow | None:
    """Return the windows of the arms, or None if there is no room for a window through which powder escapes."""
    window = ArmWindow(max(_NEAR_ARMS * lengths.arm, _NEAR_CENTRE), wall / np.sqrt(2.0) / pitch)
    width = 0.5 - lengths.inset - lengths.arm / 2 - window.post - window.near
    return window if width * np.sqrt(2.0) * pitch >= _SMALLEST_WINDOW else None
