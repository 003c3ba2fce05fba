"""Find the territory of each part: the voxels that its supports may use."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Ints
from amprep.geometry.plates.shadow import shadow_of
from amprep.geometry.supports.drift import DriftLimits, have_path_within, within_drift
from amprep.geometry.supports.footprints import box, union_of
from amprep.geometry.supports.territory import Columns, columns_of, territory_region
from amprep.geometry.voxels.grid import Grid
from amprep.model.build import PlacedPart
from amprep.model.supports import Voxel
from amprep.model.supports.rules import TerritoryRules
from amprep.supports.grid.red_squares import SupportGrid
from amprep.supports.rules import PlanningRules

if TYPE_CHECKING:
    from manifold3d import CrossSection


class PartTerritory(NamedTuple):
    """Where the supports of one part may be.

    Attributes
    ----------
    outline
        Polygons ``(k, 2)`` mm of the region of the plate, disjoint, with the inside to their left.
    boxes
        ``(k, 2, 3)`` mm, corners of the boxes of parts above or below the part; supports may not enter them.
    first
        Row and column of the first column of voxels in `opened`.
    opened
        ``(nz, ny, nx)`` bool: the voxels that supports may use, if they are free; no voxels beside them are open.
    reachable
        ``(m,)`` bool: from which red squares of the part a path within the drift leads to the plate.
    limits
        Largest drift of the supports.
    """

    outline: tuple[Floats, ...]
    boxes: Floats
    first: tuple[int, int]
    opened: Bools
    reachable: Bools
    limits: DriftLimits

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns of `opened` in the whole grid."""
        y, x = (slice(a, a + n) for a, n in zip(self.first, self.opened.shape[1:], strict=True))
        return y, x

    def allows(self, voxels: Ints) -> Bools:
        """Tell which voxels ``(n, 3)`` k, y, x of the grid are open."""
        inner = np.asarray(voxels).reshape(-1, 3) - (0, *self.first)
        within = ((inner >= 0) & (inner < self.opened.shape)).all(axis=1)
        found = np.zeros(len(inner), np.bool_)
        found[within] = self.opened[tuple(inner[within].T)]
        return found

    def section(self) -> "CrossSection":
        """Return the region of the plate."""
        from manifold3d import CrossSection, FillRule

        return CrossSection(list(self.outline), FillRule.Positive)


class _Shadows:
    """Shadows and boxes of placed parts; copies in one orientation share the computation."""

    def __init__(self, parts: Sequence[PlacedPart]) -> None:
        self._parts = parts
        self._known: dict[tuple[int, bytes], CrossSection] = {}
        meshes = [each.mesh for each in parts]
        self.low = np.array([mesh.bounds[0] for mesh in meshes]).reshape(-1, 3)
        self.high = np.array([mesh.bounds[1] for mesh in meshes]).reshape(-1, 3)

    def __getitem__(self, number: int) -> "CrossSection":
        placed = self._parts[number]
        turn, shift = placed.matrix[:3, :3], placed.matrix[:2, 3]
        key = id(placed.part), turn.tobytes()
        if key not in self._known:
            points, triangles = placed.part.mesh.arrays
            self._known[key] = shadow_of(points @ turn.T, triangles)
        return self._known[key].translate(shift.tolist())

    def apart(self, number: int) -> tuple[Bools, Bools]:
        """Tell which boxes of parts are apart from that of one part, in space and in plan."""
        gap = np.maximum(self.low - self.high[number], self.low[number] - self.high)
        apart = gap > -CONTACT_TOLERANCE
        return apart.any(axis=1), apart[:, :2].any(axis=1)

    def near(self, number: int, margin: float) -> Bools:
        """Tell which boxes of other parts meet that of one part in plan when it is grown by a margin."""
        gap = np.maximum(self.low - self.high[number], self.low[number] - self.high)[:, :2]
        near: Bools = (gap < margin).all(axis=1)
        near[number] = False
        return near


def find_territories(
    parts: Sequence[PlacedPart], laid: SupportGrid, rules: PlanningRules
) -> tuple[PartTerritory, ...]:
    """Return the territory of each part; none where the rules let parts share all space.

    Columns of voxels that are only partly inside the territory are closed, except directly below red squares. If
    red squares have no path to the plate then, columns are open whose axis is inside.

    Parameters
    ----------
    parts
        The placed parts.
    laid
        The grid of the build, with the red squares.
    rules
        Margin of the territories, and the largest drift of supports.
    """
    if rules.territory == "shared":
        return ()
    shadows = _Shadows(parts)
    return tuple(_territory_of(number, placed, shadows, laid, rules) for number, placed in enumerate(parts))


def margin_of(placed: PlacedPart, rules: TerritoryRules) -> float:
    """Return the margin (mm) around the shadow of a part: its own, or that of the rules."""
    own = placed.part.overrides.territory_margin_mm
    return rules.territory_margin_mm if own is None else own


def _territory_of(
    number: int, placed: PlacedPart, shadows: _Shadows, laid: SupportGrid, rules: PlanningRules
) -> PartTerritory:
    red = laid.red.square[laid.red.part == number]
    limits = DriftLimits(laid.grid.pitch, laid.grid.step, rules.drift_ratio, rules.drift_mm)
    if not (red[:, 0] > 0).any():
        closed = np.zeros((len(laid.voxels), 0, 0), np.bool_)
        return PartTerritory((), np.empty((0, 2, 3)), (0, 0), closed, red[:, 0] == 0, limits)
    margin = margin_of(placed, rules)
    near, (in_space, in_plan) = shadows.near(number, margin), shadows.apart(number)
    own = shadows[number]
    if not placed.part.is_solid:
        own += _squares(red, laid.grid)
    region = territory_region(
        own,
        [shadows[each] for each in np.flatnonzero(near & ~in_plan).tolist()],
        [box(shadows.low[each], shadows.high[each]) for each in np.flatnonzero(near & in_plan).tolist()],
        margin,
    )
    stacked = near & in_space & ~in_plan
    boxes = np.stack([shadows.low[stacked], shadows.high[stacked]], axis=1)
    first, opened, reachable = _open_voxels(columns_of(region, laid.grid), red, boxes, laid, limits)
    outline = tuple(np.asarray(loop) for loop in region.to_polygons())
    return PartTerritory(outline, boxes, first, opened, reachable, limits)


def _squares(red: Ints, grid: Grid) -> "CrossSection":
    """Return the columns of red squares in plan."""
    corners = grid.origin[:2] + np.unique(red[:, :0:-1], axis=0) * grid.pitch
    return union_of([box(corner, corner + grid.pitch) for corner in corners])


def _open_voxels(
    columns: Columns, red: Ints, boxes: Floats, laid: SupportGrid, limits: DriftLimits
) -> tuple[tuple[int, int], Bools, Bools]:
    """Return the first column and the open voxels of a territory, and which red squares have a path in them."""
    reachable = red[:, 0] == 0
    rows, lines = (np.flatnonzero(columns.touched.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return (0, 0), np.zeros((len(laid.voxels), 0, 0), np.bool_), reachable
    y, x = (slice(int(each[0]), int(each[-1]) + 1) for each in (rows, lines))
    whole, touched, centred = (each[y, x] for each in columns)
    inner = red - (0, y.start, x.start)
    within = np.flatnonzero(((inner[:, 1:] >= 0) & (inner[:, 1:] < touched.shape)).all(axis=1) & ~reachable)
    inner = inner[within]
    opened = within_drift(inner, (len(laid.voxels), *touched.shape), limits) & touched
    _close_boxes(opened, boxes, (y.start, x.start), laid.grid)
    below = np.zeros_like(opened)
    below[inner[:, 0] - 1, inner[:, 1], inner[:, 2]] = True
    free = laid.voxels[:, y, x] == Voxel.FREE
    tight, loose = (opened & (chosen | below) for chosen in (whole, whole | centred))
    have_path = have_path_within(free & tight, inner, limits)
    if not have_path.all():
        wider = have_path_within(free & loose, inner, limits)
        tight, have_path = (loose, wider) if (wider & ~have_path).any() else (tight, have_path)
    reachable[within] = have_path
    return (y.start, x.start), tight, reachable


def _close_boxes(opened: Bools, boxes: Floats, first: tuple[int, int], grid: Grid) -> None:
    """Close the voxels that meet the interior of boxes; `opened` is modified in place."""
    origin = grid.origin + np.array([first[1], first[0], 0.0]) * grid.size
    for low, high in boxes:
        start = np.floor((low + CONTACT_TOLERANCE - origin) / grid.size).astype(np.int64)
        end = np.ceil((high - CONTACT_TOLERANCE - origin) / grid.size).astype(np.int64)
        x, y, z = (slice(max(int(a), 0), max(int(b), 0)) for a, b in zip(start, end, strict=True))
        opened[z, y, x] = False
