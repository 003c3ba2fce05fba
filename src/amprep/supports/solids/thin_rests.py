"""Cut away what is thinner than the least section in a finished support."""

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.geometry.connectors.least_width import LeastSection
from amprep.geometry.merging.union import arrays_of, evaluated
from amprep.geometry.slicing.contours import SlicedMesh
from amprep.geometry.supports.footprints import box, union_of
from amprep.geometry.supports.narrow_ends import narrow_ends, narrow_ends_in
from amprep.geometry.supports.outlines import Contours, contours_in, contours_of, plane_outlines
from amprep.geometry.supports.thin_rests import are_in, bounds_of, find_thin_rests
from amprep.kernels.supports.outlines import PlaneOutlines

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_STEP = 0.25
"""Distance (mm) of sections."""

_EACH_WAIST = 2
"""In every n-th section waists are looked for, too."""

_MOST_TRIANGLES = 1.6e7
"""Largest product of the numbers of triangles and sections of one support."""

_SECTIONS = (80, 240)
"""Least and largest value of the number of sections to which that leads."""

_FINE = 0.15
"""Height (mm) of the layers in which thin places are cut away."""

_BEYOND = 0.6
"""Distance (in layers) of the sections above and below a layer in which something was cut away from its middle."""

_BESIDE = 0.1
"""Distance (mm) of sections from the lowest and highest points of pieces."""

_WINDOW = 8.0
"""Distance (in widths) around thin places in which the layers above and below are looked at; half of it is judged."""

_BORDER = 2.0
"""Distance (in widths) from the border of such a window in which narrow ends are not looked at."""

_BLOCK = 16
"""Number of layers above and below a layer that are cut with it."""

_ROUNDS = 3
"""Largest number of rounds; cuts may leave other thin places."""

_TOUCH = 0.02
"""Distance (mm) up to which a rest touches a part."""

_WIDER = 0.06
"""Length (mm) by which rests are cut away wider: struts are oblique."""

_SPECK = 1e-3
"""Area (mm2) of rests that count as known."""

_LESS = 0.02
"""Length (mm) by which supports may be thinner than the least wall, because rounding takes a little away."""

_SLIVER = 0.1
"""Least width (mm) of teeth, points and necks."""

_SLOPE = 0.3
"""Height (mm) by which a tip may begin lower, because the part above it is not level."""

_HOLE_END = 0.2
"""Fraction of the height of a drain hole, at both of its ends, in which no section of it is."""

NO_HOLES = np.empty((0, 3)), np.empty((0, 3))
"""Corners of the drain holes of a support without any."""

# Strategy. The sources of thin places (narrow overhangs, drain holes) are avoided before. What is left comes from
# faces that cut cells and connectors at any place: borders of territories, walls of parts, the parts themselves, and
# drain holes. Sections at few heights, of which each drain hole has one, tell where something is thin, and sections
# close together tell there what is cut away, layer by layer, together with what led there: it may be so low that none
# of these sections meets it. Sections just above and below the layers show what cuts have left there. A rest that
# touches a part is one with the part, and stays. Pieces that float then are dropped later.


class _Place(NamedTuple):
    """Where thin places are sought: in the section at a height (mm), in it all or only in rectangles ``(k, 2)``."""

    height: float
    around: tuple[Floats, Floats] | None = None


def without_thin_rests(
    solid: "Manifold",
    parts: "Sequence[Manifold]",
    least: LeastSection,
    tip_height: float,
    holes: tuple[Floats, Floats] = NO_HOLES,
) -> "Manifold":
    """Return a support without its parts that are thinner than the least section; its pieces may float.

    Parameters
    ----------
    solid
        The finished support.
    parts
        The parts around it, as solids.
    least
        Least section of supports.
    tip_height
        Height (mm) below parts up to which ends of supports taper, down to 0.1 mm; 0 where they do not.
    holes
        Least and greatest corners ``(k, 3)`` mm of the drain holes in it.
    """
    even = _heights(solid)
    places = [_Place(height) for height in even] + _beside_holes(*holes, even, _WINDOW * least.width)
    for _ in range(_ROUNDS):
        finder = _RestFinder(solid, parts, least, tip_height, places)
        cuts: dict[int, CrossSection] = {}
        for place in places:
            layer = round(place.height / _FINE)
            if rest := _beyond(finder.rests(place), cuts.get(layer)):
                _collect(finder, layer, rest, cuts)
        if not cuts:
            break
        solid = _without(solid, cuts)
        if solid.is_empty():
            break
        places = [
            finder.around((layer + side * _BEYOND) * _FINE, rest)
            for layer, rest in cuts.items()
            for side in (-1, 1)
            if side > 0 or layer - 1 not in cuts
        ]
    return solid


def _beside_holes(low: Floats, high: Floats, even: list[float], margin: float) -> list[_Place]:
    """Return sections of the drain holes in which there is none of the `even` ones; `margin` (mm) around holes."""
    inner = _HOLE_END * (high - low)[:, 2]
    first = np.searchsorted(even, low[:, 2] + inner)
    missed = first == np.searchsorted(even, high[:, 2] - inner)
    low, high = low[missed], high[missed]
    found = []
    for height in heights_through(low[:, 2], high[:, 2]):
        own = (low[:, 2] < height) & (high[:, 2] > height)
        found.append(_Place(height, (low[own, :2] - margin, high[own, :2] + margin)))
    return found


def heights_through(low: Floats, high: Floats) -> list[float]:
    """Return few heights such that one is inside each interval from `low` to `high` ``(k,)`` mm."""
    heights: list[float] = []
    inner = _HOLE_END * (high - low)
    for number in np.argsort(high - inner, kind="stable").tolist():
        if not heights or heights[-1] < low[number] + inner[number]:
            heights.append(float(high[number] - inner[number]))
    return heights


def _collect(
    finder: "_RestFinder", layer: int, around: "CrossSection", cuts: "dict[int, CrossSection]"
) -> None:
    """Add a thin place in a layer to `cuts`, and the rests around it, layer by layer, up and down as far as any are."""
    for first, way in ((layer, -1), (layer + 1, 1)):
        each, last = first, around
        while True:
            known = cuts.get(each)
            rest = _beyond(finder.rests(finder.around(each * _FINE, last)), known)
            if each == layer:
                rest = around if rest is None else rest + around
            if rest is None and each != first:
                break
            if rest is not None:
                cuts[each] = rest if known is None else rest + known
                last = rest
            each += way


def _beyond(rest: "CrossSection | None", known: "CrossSection | None") -> "CrossSection | None":
    """Return the part of a rest that is not yet known; None for nothing."""
    if rest is None or known is None:
        return rest
    new = rest - known.offset(_WIDER)
    return None if new.area() <= _SPECK else new


def _without(solid: "Manifold", cuts: "dict[int, CrossSection]") -> "Manifold":
    """Return a solid without a region in each of some layers."""
    from manifold3d import JoinType, Manifold, OpType

    wider = {layer: rest.offset(_WIDER, JoinType.Square).simplify(_WIDER / 8) for layer, rest in cuts.items()}
    solids = [
        rest.extrude(_FINE).translate((0.0, 0.0, (layer - 0.5) * _FINE)) for layer, rest in wider.items()
    ]
    return evaluated(solid - Manifold.batch_boolean(solids, OpType.Add))


def _heights(solid: "Manifold") -> list[float]:
    """Return heights of sections: evenly spaced, and next to the lowest and highest points of pieces."""
    points, triangles = arrays_of(solid)
    height = points[triangles, 2]
    corner, z = triangles.ravel(), points[:, 2]
    lowest, highest = np.full(len(points), np.inf), np.full(len(points), -np.inf)
    np.minimum.at(lowest, corner, np.repeat(height.min(axis=1), 3))
    np.maximum.at(highest, corner, np.repeat(height.max(axis=1), 3))
    low, high = float(z.min()), float(z.max())
    most = int(np.clip(_MOST_TRIANGLES / len(triangles), *_SECTIONS))
    count = int(np.clip(np.ceil((high - low) / _STEP), 2, most))
    even = low + (high - low) * (np.arange(count) + 0.5) / count
    ends = np.concatenate([z[lowest >= z] + _BESIDE, z[highest <= z] - _BESIDE])
    ends = np.unique(np.round(ends / _BESIDE) * _BESIDE + 1e-4)
    ends = ends[(ends > low) & (ends < high)]
    chosen = (
        ends[:: int(np.ceil(len(ends) / max(most - count, 1)))] if most > count and len(ends) else ends[:0]
    )
    return np.sort(np.concatenate([even, chosen])).tolist()  # type: ignore[no-any-return]


class _SupportSections:
    """The sections of a solid, which is cut at the heights of several at once."""

    def __init__(self, solid: "Manifold") -> None:
        self._mesh = SlicedMesh(*arrays_of(solid))
        self._known: dict[float, tuple[PlaneOutlines, int]] = {}
        self.at = cache(self._at)

    def cut(self, heights: Floats) -> PlaneOutlines:
        """Cut the solid at ascending heights ``(k,)`` mm, and return the outlines."""
        outlines = plane_outlines(self._mesh.contours(heights))
        self._known.update((height, (outlines, plane)) for plane, height in enumerate(heights.tolist()))
        return outlines

    def _at(self, height: float) -> Contours:
        """Return the contours at a height, mm. The layers near it are cut with it."""
        if height not in self._known:
            layers = (round(height / _FINE) + np.arange(-_BLOCK, _BLOCK + 1)) * _FINE
            new = [each for each in layers.tolist() if each not in self._known]
            self.cut(np.unique([*new, height]))
        outlines, plane = self._known[height]
        return contours_in(outlines, plane)


class _RestFinder:
    """Finds the rests in sections of a support."""

    def __init__(
        self,
        solid: "Manifold",
        parts: "Sequence[Manifold]",
        least: LeastSection,
        tip_height: float,
        places: Sequence[_Place],
    ) -> None:
        self._parts, self._tip_height = parts, tip_height
        self._width = max(least.width - _LESS, 0.0)
        self._area = max(least.area - 2.0 * _LESS * least.width, 0.0)
        self._sections = _SupportSections(solid)
        self._ends = self._find_ends(places)
        self._part_section = cache(lambda number, height: parts[number].slice(height))
        self._grown_section = cache(
            lambda number, height: contours_of(parts[number].slice(height).offset(_TOUCH))
        )
        self._bounds = np.array([part.bounding_box() for part in parts]).reshape(-1, 6)

    def around(self, height: float, rest: "CrossSection") -> _Place:
        """Return the section at a height (mm) around the pieces of a region."""
        low, high = bounds_of(rest.decompose())
        margin = _WINDOW * self._width
        return _Place(height, (low - margin, high + margin))

    def _find_ends(self, places: Sequence[_Place]) -> dict[float, Floats]:
        """Cut the solid at the heights of places, and return the narrow ends in those that are whole sections."""
        whole = np.unique([place.height for place in places if place.around is None])
        self._sections.cut(np.unique([place.height for place in places if place.around is not None]))
        waists = [number % _EACH_WAIST == 0 for number in range(len(whole))]
        found = narrow_ends_in(self._sections.cut(whole), waists, self._width, self._area)
        return {float(whole[plane]): ends for plane, ends in found.items()}

    def _narrow_ends(self, place: _Place, region: Contours) -> Floats:
        """Return the narrow ends ``(k, 2)`` mm in a place."""
        if place.around is None:
            return self._ends.get(place.height, np.empty((0, 2)))
        return narrow_ends(region, self._width, self._area, lambda points: self._are_judged(points, place))

    def rests(self, place: _Place) -> "CrossSection | None":
        """Return what is too thin in a section; None for nothing. Near the border of the place nothing is judged."""
        if place.around is None and place.height not in self._ends:
            return None
        region = self._sections.at(place.height)
        if place.around is not None:
            region = contours_of(region.inside(*place.around))
        ends = self._narrow_ends(place, region)
        ends = ends[~self._are_held(ends, place.height)]
        if not len(ends):
            return None
        found = find_thin_rests(
            region,
            ends,
            self._width,
            self._area,
            lambda rest: self._is_kept(rest, place.height),
            lambda points: self._are_held(points, place.height),
            lambda points: self._are_judged(points, place),
        )
        if found and place.around is not None:
            low, high = place.around
            margin = _WINDOW / 2.0 * self._width
            inner = union_of([box(*each) for each in zip(low + margin, high - margin, strict=True)])
            found = [rest ^ inner for rest in found]
        whole = union_of(found)
        return None if whole.is_empty() else whole

    def _are_held(self, points: Floats, height: float) -> Bools:
        """Tell which points ``(k, 2)`` mm of a section touch a part."""
        held = np.zeros(len(points), np.bool_)
        for part in range(len(self._parts)) if len(points) else ():
            held |= self._grown_section(part, height).cover(points)
        return held

    def _are_judged(self, points: Floats, place: _Place) -> Bools:
        """Tell which points ``(k, 2)`` mm are not near a border of a place, which cuts the section."""
        if place.around is None:
            return np.ones(len(points), np.bool_)
        low, high = place.around
        border = _BORDER * self._width
        return are_in(points, low + border, high - border)

    def _is_kept(self, rest: "CrossSection", height: float) -> bool:
        """Tell whether a rest touches a part, or is a tip that is not too thin."""
        wider, near = rest.offset(_TOUCH), self._near(rest)
        if any(not (wider ^ self._part_section(part, height)).is_empty() for part in near):
            return True
        if not self._tip_height or rest.offset(-_SLIVER / 2.0).is_empty():
            return False
        return any(self._is_below(rest, height, part) for part in near)

    def _is_below(self, rest: "CrossSection", height: float, part: int) -> bool:
        """Tell whether a part is above a rest, at most as high as tips are long."""
        reach = self._tip_height + _SLOPE
        if not (rest ^ self._part_section(part, height + reach)).is_empty():  # nearly always, and cheaper
            return True
        space = rest.extrude(reach).translate((0.0, 0.0, height))
        return not (self._parts[part] ^ space).is_empty()

    def _near(self, rest: "CrossSection") -> list[int]:
        """Return the numbers of the parts whose boxes meet a rest in plan."""
        left, front, right, back = rest.bounds()
        meets = (self._bounds[:, :2] <= (right + _TOUCH, back + _TOUCH)).all(axis=1)
        meets &= (self._bounds[:, 3:5] >= (left - _TOUCH, front - _TOUCH)).all(axis=1)
        return np.flatnonzero(meets).tolist()
