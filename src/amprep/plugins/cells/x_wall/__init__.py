"""X-shaped walls that meet their neighbours only every n-th layer (thesis 3.5, figures 1 and 2)."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from amprep.errors import JobError
from amprep.model import CellRequest, Cells, Progress, Role, Stop, Template
from amprep.model.supports.edges import square_keys
from amprep.plugins.cells.x_wall.shapes import Window, solid_x, surface_x

HAIR = 1e-3
"""Share of the square: how much thinner oblique cells are half way up, times the number of their direction.

So no two cells of different directions have sides in a common plane. Uniting such cells is where manifold3d
leaves triangles folded onto one another.
"""

_USUAL = 0.3
"""mm; what a fine scan track with its neighbour is wide, and what powder still runs through."""

_HOLE = 0.2
"""mm; what powder runs through at the least."""

_NEAR, _AXIS = 0.7, 0.1
"""How near to the cell's centre windows begin: in `arm`s (half of one is inside the crossing), at least a share."""

_POST, _LEAST_WINDOW = 0.15, 0.3
"""mm along the wall: what a window leaves of the arm's end where it is widest, and how wide it is at least."""


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
    """The parameters as shares of the pitch: half of a wall's width along x, half of a gap, windows if any."""

    arm: float
    inset: float
    window: Window | None = None


def emit_x_walls(request: CellRequest, *, params: XWallParams, stop: Stop, progress: Progress) -> Cells:  # noqa: ARG001
    """Put an X under the map of each edge; its size at a plane depends on the plane alone.

    At both planes of every `join_every`-th layer the arms reach the sides of the square, at the others they
    are drawn back, with a slope between. A layer between two joined ones has a waist. Unless all layers are
    joined, arms have windows where cells cross: powder leaves from between their walls.
    """
    shares = _shares(request.frame.pitch, params)
    if params.wall_mm == 0.0 and not request.allow_surface:
        raise JobError(
            "x-wall: wall_mm = 0 makes walls without thickness, which this target cannot read; set wall_mm"
        )
    rows = _insets(request.edges.plane, params.join_every, shares.inset)
    rows[request.role == Role.CONNECTOR] = 0.0
    hair = np.where(params.wall_mm == 0.0, 0.0, HAIR * request.edges.direction)
    rows = np.column_stack([rows, hair, _beside_oblique(request)])
    kinds, template = np.unique(rows, axis=0, return_inverse=True)
    templates = tuple(_template(shares, kind[:3], kind[3], bool(kind[4])) for kind in kinds.tolist())
    edge = np.arange(len(request.edges))
    hole = _HOLE if params.join_every > 1 and params.wall_mm != 0.0 else 0.0
    return Cells(templates, template.ravel(), edge, request.matrices, hole=hole)


def _beside_oblique(request: CellRequest) -> NDArray[np.bool_]:
    """Tell which edges are oblique or have a square in common with one that is: their walls cross."""
    edges, oblique = request.edges, request.edges.direction > 0
    found = oblique.copy()
    for square in (square_keys(edges.upper), square_keys(edges.lower)):
        found |= np.isin(square, square[oblique])
    return np.asarray(found & (request.role != Role.CONNECTOR))


def _insets(plane: NDArray[np.integer], every: int, inset: float) -> NDArray[np.float64]:
    """Return how far the arms below each plane are drawn back at the bottom, half way up and at the top."""
    lower = plane - 1
    low, high = (np.where(_is_joined(each, every), 0.0, inset) for each in (lower, plane))
    between = np.where(low == high, inset, (low + high) / 2)
    return np.column_stack([low, np.where(lower % every == every - 1, 0.0, between), high])


def _template(shares: "_Shares", insets: list[float], hair: float, pierced: bool) -> Template:
    """Return an X, `pierced` by windows or not; the insets are those of `_insets`."""
    low, waist, high = insets
    window = shares.window if pierced else None
    if shares.arm == 0.0:
        return surface_x(low, waist, high, window)
    return solid_x(shares.arm, low, waist, high, hair, window)


def x_wall_material(pitch: float, step: float, params: XWallParams) -> tuple[float, float]:
    """Volume in mm3 of an upright and of an oblique edge, on average over the layers (and the directions).

    Windows are left out: they take as much from an upright edge beside an oblique one, so that a router which
    saves material must not go aside for their sake.
    """
    shares = _shares(pitch, params)
    if params.wall_mm == 0.0:
        return 0.0, 0.0
    layers = _insets(params.join_every * 2 + np.arange(params.join_every), params.join_every, shares.inset)
    upright, *oblique = (_mean_volume(shares, layers, way) for way in range(5))
    return upright * pitch * pitch * step, float(np.mean(oblique)) * pitch * pitch * step


def _mean_volume(shares: "_Shares", layers: NDArray[np.float64], way: int) -> float:
    """Mean share of the prism that the X of each layer fills."""
    templates = [_template(shares, layer, HAIR * way, pierced=False) for layer in layers.tolist()]
    return float(np.mean([template.mesh.signed_volume for template in templates]))


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
    return replace(shares, window=_window(pitch, shares)) if params.join_every > 1 else shares


def _window(pitch: float, shares: _Shares) -> Window | None:
    """Return the windows of the arms, None where there is no room for such as powder runs through."""
    window = Window(max(_NEAR * shares.arm, _AXIS), _POST / np.sqrt(2.0) / pitch)
    width = 0.5 - shares.inset - shares.arm / 2 - window.post - window.near
    return window if width * np.sqrt(2.0) * pitch >= _LEAST_WINDOW else None
