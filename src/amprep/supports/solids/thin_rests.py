"""Cut away what is thinner than the least section in a finished support."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.geometry.connectors.least_width import LeastSection
from amprep.geometry.merging.union import arrays_of, evaluated
from amprep.geometry.supports.footprints import box, union_of
from amprep.geometry.supports.thin_rests import find_thin_rests

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_STEP = 0.25
"""Distance (mm) of sections."""

_MOST_TRIANGLES = 4e6
"""Largest product of the numbers of triangles and sections of one support."""

_SECTIONS = (40, 240)
"""Least and largest value of the number of sections to which that leads."""

_FINE = 0.15
"""Height (mm) of the layers in which thin places are cut away."""

_BESIDE = 0.1
"""Distance (mm) of sections from the lowest and highest points of pieces."""

_WINDOW = 8.0
"""Distance (in widths) around thin places in which the layers above and below are looked at; half of it is judged."""

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

# Strategy. The sources of thin places (narrow overhangs, drain holes) are avoided before. What is left comes from
# faces that cut cells and connectors at any place: borders of territories, walls of parts, the parts themselves.
# Sections at few heights tell where something is thin, and sections close together tell there what is cut away, layer
# by layer. A rest that touches a part is one with the part, and stays. Pieces that float then are dropped later.


def without_thin_rests(
    solid: "Manifold", parts: "Sequence[Manifold]", least: LeastSection, tip_height: float
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
    """
    finder = _RestFinder(parts, least, tip_height)
    places: list[tuple[float, CrossSection | None]] = [(height, None) for height in _heights(solid)]
    for _ in range(_ROUNDS):
        cuts: dict[int, CrossSection] = {}
        for height, around in places:
            layer = round(height / _FINE)
            if rest := _beyond(finder.rests(solid, height, around), cuts.get(layer)):
                _collect(finder, solid, layer, rest, cuts)
        if not cuts:
            break
        solid = _without(solid, cuts)
        places = [((layer + 0.5) * _FINE, rest) for layer, rest in cuts.items()]
    return solid


def _collect(
    finder: "_RestFinder",
    solid: "Manifold",
    layer: int,
    around: "CrossSection",
    cuts: "dict[int, CrossSection]",
) -> None:
    """Add the rests around a thin place, layer by layer, up and down as far as there are any, to `cuts`."""
    for first, way in ((layer, -1), (layer + 1, 1)):
        each, last = first, around
        while True:
            known = cuts.get(each)
            rest = _beyond(finder.rests(solid, each * _FINE, last), known)
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


class _RestFinder:
    """Finds the rests in sections of a support."""

    def __init__(self, parts: "Sequence[Manifold]", least: LeastSection, tip_height: float) -> None:
        self._parts, self._tip_height = parts, tip_height
        self._width = max(least.width - _LESS, 0.0)
        self._area = max(least.area - 2.0 * _LESS * least.width, 0.0)

    def rests(
        self, solid: "Manifold", height: float, around: "CrossSection | None" = None
    ) -> "CrossSection | None":
        """Return what is too thin in the section of a solid at a height (mm), if given, only around a region.

        None for nothing.
        """
        region = solid.slice(height)
        if around is not None:
            region ^= _boxes(around, _WINDOW * self._width)
        found = find_thin_rests(region, self._width, self._area, lambda rest: self._is_kept(rest, height))
        if found and around is not None:
            inner = _boxes(around, _WINDOW / 2.0 * self._width)
            found = [rest ^ inner for rest in found]
        whole = union_of(found)
        return None if whole.is_empty() else whole

    def _is_kept(self, rest: "CrossSection", height: float) -> bool:
        """Tell whether a rest touches a part, or is a tip that is not too thin."""
        wider = rest.offset(_TOUCH)
        if any(not (wider ^ part.slice(height)).is_empty() for part in self._around(rest)):
            return True
        return self._tip_height > 0.0 and self._is_tip(rest, height)

    def _is_tip(self, rest: "CrossSection", height: float) -> bool:
        if rest.offset(-_SLIVER / 2.0).is_empty():
            return False
        space = rest.extrude(self._tip_height + _SLOPE).translate((0.0, 0.0, height))
        return any(not (part ^ space).is_empty() for part in self._around(rest))

    def _around(self, rest: "CrossSection") -> "list[Manifold]":
        """Return the parts whose boxes meet a rest in plan."""
        left, front, right, back = rest.bounds()
        boxes = ((part, part.bounding_box()) for part in self._parts)
        return [
            part
            for part, bounds in boxes
            if bounds[0] <= right + _TOUCH and bounds[3] >= left - _TOUCH
            and bounds[1] <= back + _TOUCH and bounds[4] >= front - _TOUCH
        ]  # fmt: skip


def _boxes(region: "CrossSection", margin: float) -> "CrossSection":
    """Return the boxes of the pieces of a region, larger by a margin (mm)."""
    boxes = [np.asarray(piece.bounds()) for piece in region.decompose()]
    return union_of([box(each[:2] - margin, each[2:] + margin) for each in boxes])
