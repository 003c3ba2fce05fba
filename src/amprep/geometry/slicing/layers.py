"""Cut a body into layers: closed contours of a solid, whose overlapping shells are united, or lines of a surface."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.meshes.shells import measure_shells
from amprep.geometry.slicing.contours import PlaneContours, SlicedMesh

# Strategy. Contours are walked in the mesh, which is exact and takes about 0.1 us a point. Only where shells of a body
# overlap, which the signed area of the contours shows, a sweep unites them, some 0.5 us a point (`manifold3d`). Planes
# are cut in blocks of bounded size, so that memory does not grow with the number of layers.

RESOLUTION = 1e-4
"""mm; points that are nearer to a straight line are left out."""

_BLOCK = 400_000
"""Pairs of a triangle and a plane that are cut at once."""

_SAMPLES = 16
"""Planes at which a body whose shells are apart is searched for overlaps with itself."""

_OVERLAP = 1e-5
"""Relative difference of the areas before and after uniting from which shells overlap."""


@dataclass(frozen=True, eq=False)
class LayerContours:
    """The contours of consecutive layers; outer ones are counter-clockwise, holes clockwise.

    Attributes
    ----------
    first_layer, layers
        Number of the first layer, and how many there are.
    points, first
        ``(n, 2)`` mm, points of all contours, those of contour c from ``first[c]`` up to ``first[c + 1]``.
    layer
        ``(c,)`` layer of each contour, ascending.
    area
        ``(c,)`` mm2, negative for holes, 0 for lines.
    is_open
        Whether all of them are lines, which end where the surface ends; the last point of a closed one is its first.
    """

    first_layer: int
    layers: int
    points: Floats
    first: Int64s
    layer: Int64s
    area: Floats
    is_open: bool = False

    def of_layer(self, layer: int) -> range:
        """Return the contours of a layer."""
        low, high = np.searchsorted(self.layer, (layer, layer + 1))
        return range(int(low), int(high))

    def points_of(self, contour: int) -> Floats:
        """Return the points of a contour, ``(n, 2)`` mm."""
        return self.points[self.first[contour] : self.first[contour + 1]]

    def polylines_of(self, own: range) -> tuple[Floats, Int64s]:
        """Return consecutive contours as polylines, of which closed ones end at their first point.

        Returns
        -------
        points, first
            ``(n, 2)`` mm and ``(c + 1,)``, points of contour c from ``first[c]`` up to ``first[c + 1]``.
        """
        begins = self.first[own.start : own.stop + 1]
        if self.is_open:
            return self.points[begins[0] : begins[-1]], begins - begins[0]
        first = begins - begins[0] + np.arange(len(begins))
        picked = np.arange(first[-1]) + begins[0] - np.repeat(np.arange(len(own)), np.diff(first))
        picked[first[1:] - 1] = begins[:-1]
        return self.points[picked], first

    def length_of(self, own: range) -> float:
        """Return the length of consecutive contours, mm."""
        points, first = self.polylines_of(own)
        steps = np.hypot(*np.diff(points, axis=0).T)
        steps[first[1:-1] - 1] = 0.0
        return float(steps.sum())


class LayeredBody:
    """A body that can be cut into layers.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm, and ``(m, 3)``, outward oriented.
    is_surface
        Whether it is a surface without thickness.
    is_united
        Whether its shells were united, so that they overlap only by a fault; then only a few planes are searched.
    """

    def __init__(
        self, vertices: Floats, triangles: Int64s, *, is_surface: bool = False, is_united: bool = False
    ) -> None:
        self.is_surface = is_surface
        self._mesh = SlicedMesh(vertices, triangles)
        heights = self._mesh.linked.points[self._mesh.linked.triangles, 2]
        self._low, self._high = heights.min(axis=1), heights.max(axis=1)
        self.bottom, self.top = float(self._low.min()), float(self._high.max())
        self._unites = not is_surface and ((not is_united and self._shells_meet()) or self._overlaps())

    def blocks(self, thickness: float, layers: int, rows: int = _BLOCK) -> Iterator[LayerContours]:
        """Yield the contours of the layers from z = 0 upwards, each cut in its middle, in blocks.

        Parameters
        ----------
        thickness
            Of a layer, mm.
        layers
            Number of layers; those above the body are empty.
        rows
            About how many pairs of a triangle and a plane are cut at once.
        """
        heights = np.asarray((np.arange(layers) + 0.5) * thickness, np.float64)
        crossed = np.zeros(layers + 1, np.int64)
        np.add.at(crossed, np.searchsorted(heights, self._low, side="right"), 1)
        np.subtract.at(crossed, np.searchsorted(heights, self._high, side="right"), 1)
        block = np.cumsum(np.cumsum(crossed[:-1])) // rows
        for part in np.split(np.arange(layers), np.flatnonzero(np.diff(block)) + 1):
            yield self.cut(heights[part], int(part[0]))

    def cut(self, heights: Floats, first_layer: int = 0) -> LayerContours:
        """Return the contours at ascending heights, ``(k,)`` mm, the first of which is that of a layer."""
        if self.is_surface:
            return _ordered(self._mesh.lines(heights), first_layer, is_open=True)
        contours = self._mesh.contours(heights)
        return _ordered(_united(contours) if self._unites else contours, first_layer)

    def _shells_meet(self) -> bool:
        """Tell whether the boxes of two shells meet of which neither is a cavity."""
        shells = measure_shells(self._mesh.linked.points, self._mesh.linked.triangles)
        return int((shells.may_overlap & (shells.volume > 0.0)).sum()) > 1

    def _overlaps(self) -> bool:
        """Tell whether the body overlaps itself at one of a few planes."""
        share = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
        contours = self._mesh.contours(self.bottom + share * (self.top - self.bottom))
        before, after = (_areas(each, _SAMPLES) for each in (contours, _united(contours)))
        return bool((np.abs(before - after) > _OVERLAP * np.maximum(before, 1.0)).any())


def _areas(contours: PlaneContours, planes: int) -> Floats:
    return np.bincount(contours.plane, contours.area, planes).astype(np.float64)


def _united(contours: PlaneContours) -> PlaneContours:
    """Return the contours of the region around which those of each plane wind at least once."""
    order = np.argsort(contours.plane, kind="stable")
    united: list[Floats] = []
    planes: list[int] = []
    for one in np.split(order, np.flatnonzero(np.diff(contours.plane[order])) + 1) if len(order) else []:
        polygons = [np.asarray(each, np.float64) for each in contours.region_of(one).to_polygons()]
        united += polygons
        planes += [int(contours.plane[one[0]])] * len(polygons)
    first = np.cumsum([0] + [len(each) for each in united])
    points = np.concatenate([np.empty((0, 2)), *united])
    plane = np.array(planes, np.int64)
    return PlaneContours(
        contours.heights, plane, np.full_like(plane, -1), _signed_areas(points, first), points, first
    )


def _signed_areas(points: Floats, first: Int64s) -> Floats:
    """Return the area of each closed contour, mm2, negative for clockwise ones."""
    if len(first) < 2:
        return np.empty(0)
    own = points - np.repeat(points[first[:-1]], np.diff(first), axis=0)
    following = np.arange(1, len(points) + 1)
    following[first[1:] - 1] = first[:-1]
    cross = own[:, 0] * own[following, 1] - own[:, 1] * own[following, 0]
    return np.asarray(np.add.reduceat(cross, first[:-1]) / 2.0)


def _ordered(contours: PlaneContours, first_layer: int, *, is_open: bool = False) -> LayerContours:
    """Return contours in the order of their layers, without repeated points and points on straight lines."""
    points, first = contours.points[: contours.first[-1]], contours.first
    if not is_open:
        from amprep.kernels.slicing.outlines import straighten

        kept, kept_first = np.empty_like(points), np.empty_like(first)
        straighten(np.ascontiguousarray(points), first, RESOLUTION / 2.0, kept, kept_first)
        points, first = kept, kept_first
    count = np.diff(first)
    order = np.argsort(contours.plane, kind="stable")
    order = order[count[order] > (1 if is_open else 2)]
    begins = np.append(0, np.cumsum(count[order]))
    picked = np.arange(begins[-1]) + np.repeat(first[order] - begins[:-1], count[order])
    return LayerContours(
        first_layer,
        len(contours.heights),
        points[picked],
        begins,
        contours.plane[order] + first_layer,
        contours.area[order],
        is_open,
    )
