"""Measure how the part carries points of overhang regions."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.carried.arches import ANY_CHORD, arch_limits, fitted_bores
from amprep.geometry.overhangs.carried.borders import RegionFaces

if TYPE_CHECKING:
    from scipy.spatial import KDTree

    from amprep.kernels.overhangs.walks import CarryingLimits, WalkableFaces

TOLERANCE = 0.01
"""Lengths (mm) that exceed a limit by less are within it."""

_SPACING = 0.25
"""Distance (mm) of sample points along anchors."""

_APART = 1e5
"""Distance (mm) between the samples of two regions in the third coordinate of the search tree."""

_RIM = 0.25
"""Width (mm) of the strip along borders without anchors that is carried as what is beside it.

At the open end of a bridge or bore no straight line may lead from anchor to anchor, as the border is oblique or bent.
"""

TWICE = 2.1
"""Lines through a point that lead straight across are at most so many times its shortest ledge."""

_OBLIQUE = 1.5
"""Largest distance of a point from the nearer end of an arch, as a multiple of its shortest ledge."""

_END = 1e-5
"""Walks end at least this far (mm) from the ends of anchors, so that they do not slip past them."""


class Limits(NamedTuple):
    """Limits up to which the part itself carries overhangs, as in `amprep.model.supports.rules.OverhangRules`.

    Attributes
    ----------
    angle_deg
        Overhang angle.
    ledge, bridge, bore
        Largest length, span and diameter, mm.
    plate
        Height (mm) up to which geometry is on the plate.
    layer
        Height (mm) of a layer.
    """

    angle_deg: float
    ledge: float
    bridge: float
    bore: float
    plate: float
    layer: float


class Carrier(NamedTuple):
    """The faces of overhang regions with the limits up to which the part carries them.

    Attributes
    ----------
    regions, limits
        The faces, and the limits.
    diameters, tilts
        ``(n,)`` mm of the regions that are part of a cylinder or sphere, else NaN; and ``(n, 2)`` rise of the axes of
        cylinders, mm per mm along x and y.
    arch
        ``(m,)`` mm, largest chord of an arch over each face.
    climb
        ``(m,)`` mm, how far what carries a point of each face may be above it: a layer in regions in which the part
        starts in the air, because what is higher is printed later; else infinite.
    tree
        Samples of the anchors, with their region as the third coordinate.
    owner
        Anchor of each sample.
    """

    regions: RegionFaces
    limits: Limits
    diameters: Floats
    tilts: Floats
    arch: Floats
    climb: Floats
    tree: "KDTree"
    owner: Int64s

    def ledges(self, points: Floats, face: Int64s, *, in_order: bool = False) -> Floats:
        """Return the length ``(n,)`` mm of the shortest ledge at points ``(n, 3)`` on the regions' faces ``(n,)``.

        With `in_order` only ledges count that are printed no later than the point, and none that is too long to carry
        it.
        """
        from amprep.kernels.overhangs.walks import find_ledges

        target, _ = self.nearest(points, face)
        ledges = np.empty(len(points))
        most = max(self.limits.ledge + TOLERANCE, self._longest()) if in_order else np.inf
        limits = self._kernel_limits(most, in_order=in_order)
        find_ledges(self._faces(), limits, np.ascontiguousarray(points), face, target, ledges)
        return ledges

    def spans(
        self, points: Floats, face: Int64s, ledges: Floats, *, fully: bool = False
    ) -> tuple[Floats, Floats]:
        """Return the shortest bridge and arch ``(n,)`` mm at points, infinite where there is none.

        Lines along a ring that is carried on one side only are no arches: unless the region is a cylinder or a sphere,
        an end of an arch is hardly farther from a point than its shortest ledge ``(n,)``.

        Without `fully` the search ends as soon as one is within its limit, it does not find longer ones, and only those
        count of which one end is printed no later than the point. Near a border without anchors, the lines through a
        point a little farther inside count where those through the point itself do not suffice.
        """
        bridge, arch = self._spans_at(points, face, _OBLIQUE * ledges, fully=fully)
        straight_across = np.isfinite(arch) | (bridge <= TWICE * ledges)
        left = np.flatnonzero(~(straight_across if fully else self._within_spans(bridge, arch, face)))
        inner, on = self._from_rims(points[left], face[left])
        left, inner, on = left[on >= 0], inner[on >= 0], on[on >= 0]
        more = self._spans_at(inner, on, TWICE / 2 * self.ledges(inner, on), fully=fully)
        bridge[left], arch[left] = np.minimum(bridge[left], more[0]), np.minimum(arch[left], more[1])
        return bridge, arch

    def _from_rims(self, points: Floats, face: Int64s) -> tuple[Floats, Int64s]:
        """Return points moved away from near borders without anchors, and their faces, -1 where there is none."""
        from amprep.kernels.overhangs.rims import step_from_rims

        moved, on = np.empty_like(points), np.empty(len(points), np.int64)
        step_from_rims(self._faces(), np.ascontiguousarray(points), face, _RIM, self.limits.plate, moved, on)
        return moved, on

    def _spans_at(
        self, points: Floats, face: Int64s, nearest: Floats, *, fully: bool
    ) -> tuple[Floats, Floats]:
        """Return the shortest bridge and arch of the lines through points themselves.

        Where the diameter is unknown, an end of an arch is at most `nearest` ``(n,)`` mm from the point.
        """
        from amprep.kernels.overhangs.walks import find_spans

        target, _ = self.nearest(points, face)
        spans = np.empty((len(points), 2))
        nearest = np.where(np.isnan(self.diameters[self.regions.label[face]]), nearest, np.inf)
        most = np.inf if fully else self._longest()
        find_spans(
            self._faces(),
            self._kernel_limits(most, in_order=not fully),
            np.ascontiguousarray(points),
            face,
            target,
            nearest,
            fully,
            spans,
        )
        return spans[:, 0], spans[:, 1]

    def carries(self, points: Floats, face: Int64s, ledges: Floats | None = None) -> Bools:
        """Tell which points ``(n, 3)`` mm on the regions' faces ``(n,)`` the part carries.

        The shortest ledges ``(n,)`` in order are measured unless they are given.
        """
        if ledges is None:
            ledges = self.ledges(points, face, in_order=True)
        carried = ledges <= self.limits.ledge + TOLERANCE
        left = np.flatnonzero(~carried)
        bridge, arch = self.spans(points[left], face[left], ledges[left])
        carried[left] = self._within_spans(bridge, arch, face[left])
        return np.asarray(carried)

    def _within_spans(self, bridge: Floats, arch: Floats, face: Int64s) -> Bools:
        """Tell which bridges and arches over faces are within their limits."""
        return np.asarray((bridge <= self.limits.bridge + TOLERANCE) | (arch <= self.arch[face] + TOLERANCE))

    def nearest(self, points: Floats, face: Int64s) -> tuple[Floats, Floats]:
        """Return the point ``(n, 2)`` of the nearest anchor, and a lower bound ``(n,)`` mm on its distance in plan.

        Where the region has no anchor, these are NaN and infinity.
        """
        if not len(self.owner):
            return np.full((len(points), 2), np.nan), np.full(len(points), np.inf)
        keys = np.column_stack([points[:, :2], _APART * self.regions.label[face]])
        distance, sample = self.tree.query(keys)
        distance = np.asarray(distance)
        start, end = (self.regions.anchors[self.owner[sample], i] for i in (0, 1))
        along = end - start
        square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
        share = np.einsum("ij,ij->i", points[:, :2] - start, along) / square
        end_share = np.minimum(_END / np.sqrt(square), 0.5)
        target = start + np.clip(share, end_share, 1 - end_share)[:, None] * along
        alien = distance > _APART / 2
        target[alien] = np.nan
        return target, np.where(alien, np.inf, np.maximum(distance - _SPACING / 2, 0.0))

    def farthest(self, face: Int64s) -> Floats:
        """Return the greatest distance (mm) from the nearest anchor at which a point of each face may be carried."""
        chord = np.maximum(
            self.limits.bridge, np.where(self.arch[face] < ANY_CHORD, self.arch[face], self._width(face))
        )
        return np.asarray(np.maximum(self.limits.ledge, chord / 2 + _RIM) + TOLERANCE)

    def _width(self, face: Int64s) -> Floats:
        return np.nan_to_num(self.diameters[self.regions.label[face]])

    def _faces(self) -> "WalkableFaces":
        from amprep.kernels.overhangs.walks import WalkableFaces

        return WalkableFaces(self.regions.corners, self.regions.beyond)

    def _longest(self) -> float:
        """Return a length (mm) that lines which carry points do not exceed, but for oblique lines across bores."""
        chords = self.arch[self.arch < ANY_CHORD]
        bores = self.diameters[self.diameters <= self.limits.bore + TOLERANCE]
        return float(max(self.limits.bridge, chords.max(initial=0.0), 2 * bores.max(initial=0.0)) + TOLERANCE)

    def _kernel_limits(self, most: float, *, in_order: bool) -> "CarryingLimits":
        from amprep.kernels.overhangs.walks import CarryingLimits

        rise = float(np.tan(np.radians(self.limits.angle_deg) / 2) / 4) - 1e-3
        bridge = self.limits.bridge + TOLERANCE
        climb = self.climb if in_order else np.full(len(self.arch), np.inf)
        tilt = self.tilts[self.regions.label]
        return CarryingLimits(bridge, self.arch + TOLERANCE, rise, tilt, most, self.limits.plate, climb)


def make_carrier(regions: RegionFaces, normals: Floats, limits: Limits, hanging: Bools) -> Carrier:
    """Prepare the faces of regions for measurements.

    Parameters
    ----------
    regions, limits
        The faces, and the limits.
    normals
        ``(k, 3)`` unit normals of all faces of the surface.
    hanging
        ``(m,)`` bool, faces of the regions in which the part starts in the air.
    """
    from scipy.spatial import KDTree

    diameters, tilts = fitted_bores(regions, normals, int(regions.label.max(initial=-1)) + 1)
    arch = arch_limits(diameters, regions.label, limits.bore + TOLERANCE, limits.angle_deg)
    samples, owner = _samples(regions.anchors)
    keys = np.column_stack([samples, _APART * regions.anchor_label[owner]])
    climb = np.where(hanging, limits.layer, np.inf)
    return Carrier(regions, limits, diameters, tilts, arch, climb, KDTree(keys), owner)


def _samples(segments: Floats) -> tuple[Floats, Int64s]:
    """Return the middles of pieces of segments that are at most `_SPACING` long, and the segment of each."""
    along = segments[:, 1] - segments[:, 0]
    pieces = np.maximum(np.ceil(np.linalg.norm(along, axis=1) / _SPACING), 1).astype(np.int64)
    owner = np.repeat(np.arange(len(segments)), pieces)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    share = (number + 0.5) / pieces[owner]
    return segments[owner, 0] + share[:, None] * along[owner], owner
