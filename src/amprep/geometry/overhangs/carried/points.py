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


class Spots(NamedTuple):
    """Points on overhang regions with the anchors nearest to them.

    Attributes
    ----------
    at, face
        ``(n, 3)`` mm, and the face of the regions ``(n,)`` that each is on.
    target
        ``(n, 2)`` mm in plan, the point of the nearest anchor; not a number where the region has none.
    least
        ``(n,)`` mm, a lower bound on its distance in plan; infinite where the region has none.
    """

    at: Floats
    face: Int64s
    target: Floats
    least: Floats

    def take(self, rows: Int64s) -> "Spots":
        """Return some of the points."""
        return Spots(self.at[rows], self.face[rows], self.target[rows], self.least[rows])


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

    def spots(self, points: Floats, face: Int64s) -> Spots:
        """Return points ``(n, 3)`` mm on the regions' faces ``(n,)`` with the anchors nearest to them."""
        if not len(self.owner):
            return Spots(points, face, np.full((len(points), 2), np.nan), np.full(len(points), np.inf))
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
        least = np.where(alien, np.inf, np.maximum(distance - _SPACING / 2, 0.0))
        return Spots(np.ascontiguousarray(points), face, target, least)

    def ledges(self, spots: Spots, *, in_order: bool = False) -> Floats:
        """Return the length ``(n,)`` mm of the shortest ledge at each point.

        With `in_order` only ledges count that are printed no later than the point, and none that is too long to carry
        it.
        """
        most = np.maximum(self._longest(), self.limits.ledge + TOLERANCE) if in_order else self._endless()
        return self._ledges(spots, self._kernel_limits(most, in_order=in_order))

    def _ledges(self, spots: Spots, limits: "CarryingLimits") -> Floats:
        from amprep.kernels.overhangs.walks import find_ledges

        ledges = np.empty(len(spots.at))
        find_ledges(self._faces(), limits, spots.at, spots.face, spots.target, ledges)
        return ledges

    def spans(self, spots: Spots, ledges: Floats) -> tuple[Floats, Floats]:
        """Return the shortest bridge and arch ``(n,)`` mm at points, infinite where there is none.

        Lines along a ring that is carried on one side only are no arches: unless the region is a cylinder or a sphere,
        an end of an arch is hardly farther from a point than its shortest ledge ``(n,)``.

        Near a border without anchors, the lines through a point a little farther inside count where those through the
        point itself do not lead straight across.
        """
        limits = self._kernel_limits(self._endless(), in_order=False)
        bridge, arch = self._spans(spots, _OBLIQUE * ledges, limits)
        left = np.flatnonzero(~np.isfinite(arch) & (bridge > TWICE * ledges))
        rows, inner = self._from_rims(spots.take(left))
        left = left[rows]
        more = self._spans(inner, TWICE / 2 * self._ledges(inner, limits), limits)
        bridge[left], arch[left] = np.minimum(bridge[left], more[0]), np.minimum(arch[left], more[1])
        return bridge, arch

    def _spans(self, spots: Spots, nearest: Floats, limits: "CarryingLimits") -> tuple[Floats, Floats]:
        """Return the shortest bridge and arch of the lines through points themselves.

        Where the diameter is unknown, an end of an arch is at most `nearest` ``(n,)`` mm from the point.
        """
        from amprep.kernels.overhangs.walks import find_spans

        spans = np.empty((len(spots.at), 2))
        nearest = self._nearest_ends(spots, nearest)
        find_spans(self._faces(), limits, spots.at, spots.face, spots.target, nearest, spans)
        return spans[:, 0], spans[:, 1]

    def _nearest_ends(self, spots: Spots, nearest: Floats) -> Floats:
        return np.where(np.isnan(self.diameters[self.regions.label[spots.face]]), nearest, np.inf)

    def _from_rims(self, spots: Spots) -> tuple[Int64s, Spots]:
        """Return the rows of points near borders without anchors, and these points moved away from there."""
        from amprep.kernels.overhangs.rims import step_from_rims

        moved, on = np.empty_like(spots.at), np.empty(len(spots.at), np.int64)
        step_from_rims(self._faces(), spots.at, spots.face, _RIM, self.limits.plate, moved, on)
        rows = np.flatnonzero(on >= 0)
        return rows, self.spots(moved[rows], on[rows])

    def carries(self, spots: Spots, ledges: Floats | None = None) -> Bools:
        """Tell which points the part carries: by a ledge, a bridge or an arch within its limit.

        Only bridges and arches count of which one end is printed no later than the point. The shortest ledges ``(n,)``
        in order are measured unless they are given.
        """
        if ledges is None:
            ledges = self.ledges(spots, in_order=True)
        carried = ledges <= self.limits.ledge + TOLERANCE
        limits = self._kernel_limits(self._longest(), in_order=True)
        left = np.flatnonzero(~carried)
        carried[left] = self._spanned(spots.take(left), _OBLIQUE * ledges[left], limits)
        left = left[~carried[left]]
        left = left[spots.least[left] <= self.farthest(spots.face[left])]
        rows, inner = self._from_rims(spots.take(left))
        timeless = limits._replace(climb=np.full(len(self.climb), np.inf))
        carried[left[rows]] = self._spanned(inner, TWICE / 2 * self._ledges(inner, timeless), limits)
        return np.asarray(carried)

    def _spanned(self, spots: Spots, nearest: Floats, limits: "CarryingLimits") -> Bools:
        """Tell through which points themselves bridges or arches lead within their limits; as `_spans`."""
        from amprep.kernels.overhangs.walks import find_spanned

        spanned = np.empty(len(spots.at), np.bool_)
        nearest = self._nearest_ends(spots, nearest)
        least = np.maximum(spots.least - 2 * _END, 0.0)
        find_spanned(self._faces(), limits, spots.at, spots.face, spots.target, nearest, least, spanned)
        return spanned

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

    def _longest(self) -> Floats:
        """Return lengths ``(m,)`` mm that lines which carry points of each face do not exceed.

        Oblique lines across bores whose diameter is within its limit are the exception.
        """
        chords = self.arch[self.arch < ANY_CHORD]
        bores = self.diameters[self.diameters <= self.limits.bore + TOLERANCE]
        bore = max(self.limits.bridge, chords.max(initial=0.0), 2 * bores.max(initial=0.0))
        own = np.where(self.arch < ANY_CHORD, np.maximum(self.limits.bridge, self.arch), bore)
        return np.asarray(own + 2 * TOLERANCE)

    def _endless(self) -> Floats:
        return np.full(len(self.arch), np.inf)

    def _kernel_limits(self, most: Floats, *, in_order: bool) -> "CarryingLimits":
        from amprep.kernels.overhangs.walks import CarryingLimits

        rise = float(np.tan(np.radians(self.limits.angle_deg) / 2) / 4) - 1e-3
        bridge = self.limits.bridge + TOLERANCE
        climb = self.climb if in_order else self._endless()
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
