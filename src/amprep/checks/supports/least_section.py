"""Judge the least section: no horizontal section of a support is thinner or smaller than the rules allow.

Strategy. Horizontal planes cut each finished solid. A connected piece of a section is too narrow if nothing is left of
it when its border moves inwards by half the least wall: no disc of that size fits in it. A fin is too thin if it
reaches far beyond what such discs cover; near the discs are the corners, which no disc fills. A piece beside a wall of
a part is one with the part there, and is judged together with it. Pieces of a shape that is known to be right need no
further judge (`amprep.checks.supports.shapes`). What is thin in one section, but not in those a least wall above and
below it, is a burr and no wall. Ends that taper on purpose, of teeth, points and necks, may be as narrow as 0.1 mm, or
as they are wide if that is less, up to their height below the part.
"""

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.checks.supports import beams
from amprep.checks.supports.shapes import STRAIGHT, KnownShapes
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.geometry.plates.inward import shrunk
from amprep.geometry.slicing.outlines import outlines_of
from amprep.model.build import Build, BuildSettings, Lattice, PlacedPart, SupportBody
from amprep.model.control import Stop
from amprep.model.supports.sizes import SupportSizes

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

LEAST_WALL = "least wall"
LEAST_CONTACT = "least contact"

TOLERANCE = 0.03
"""Length (mm) by which a section may be thinner than the least wall, because circles are polygons and files round."""

_STEP = 0.5
"""Distance (mm) of sections."""

_MOST_SECTIONS = 40
"""Largest number of sections of one support."""

_CORNER = 1.5
"""Distance (in least walls) up to which corners reach beyond the discs that fit in them: those of 30 degrees do."""

_TOUCH = 0.02
"""Distance (mm) up to which a piece touches a part."""

_SLIVER = 0.1
"""Least width (mm) of tips: borders of territories and walls may cut teeth and points, but leave no slivers."""

_SLOPE = 0.3
"""Height (mm) by which a tip may begin lower, because the part above it is not level."""

_SEGMENTS = 24
"""Sides of the polygons that stand for circles."""

_KEPT = 16
"""Number of parts whose solids are kept."""

_SPECK = 1e-3
"""Area (mm2) that offsets of polygons leave by rounding."""


class ThinPlace(NamedTuple):
    """A place where a support is too thin.

    Attributes
    ----------
    promise
        `LEAST_WALL` or `LEAST_CONTACT`.
    size
        Thickness in mm, or area in mm2.
    position_mm
        ``(3,)``.
    is_fin
        Whether the rest of the piece is thick enough.
    """

    promise: str
    size: float
    position_mm: Floats
    is_fin: bool = False


class ThinPlaces(NamedTuple):
    """The places where a support is too thin, and how many sections were judged."""

    places: list[ThinPlace]
    sections: int


def check_least_section(
    build: Build, stop: Stop, solids: KnownSolids | None = None
) -> tuple[list[Violation], int]:
    """Return the supports that are too thin somewhere, and the number of sections that were judged.

    Walls without thickness are not judged. `solids` are those that other judges have made.
    """
    found: list[Violation] = []
    sections = 0
    rules = build.settings.rules
    if rules.least_wall_mm <= 0.0 and rules.least_contact_mm2 <= 0.0:
        return found, sections
    judge = _SectionJudge(build, solids or KnownSolids())
    for body in build.supports:
        if stop():
            break
        if body.lattice is not None and len(body.lattice.radii):
            found += _thin_beams(body.name, body.lattice, build.settings)
        if not body.surface:
            thin = judge.thin_places(body)
            sections += thin.sections
            found += _violations(body, build.settings, thin.places)
    return found, sections


def _violations(body: SupportBody, settings: BuildSettings, places: Sequence[ThinPlace]) -> list[Violation]:
    found = []
    rules = settings.rules
    for promise, limit, unit in (
        (LEAST_WALL, rules.least_wall_mm, "mm"),
        (LEAST_CONTACT, rules.least_contact_mm2, "mm2"),
    ):
        own = [place for place in places if place.promise == promise]
        if own:
            worst = min(own, key=lambda place: place.size)
            what = "a fin of" if worst.is_fin else "a section of"
            message = (
                f"{what} {worst.size:.3f} {unit}, expected at least {limit:g} {unit}, at "
                f"{place_words(worst.position_mm)} mm ({len(own)} such sections)"
            )
            found.append(Violation(promise, body.name, message))
    return found


def _thin_beams(name: str, lattice: Lattice, settings: BuildSettings) -> list[Violation]:
    """Judge the thinnest beam itself; sections are those of the mesh that stands in for beams."""
    limits = _limits_of(settings)
    width, place = beams.thinnest_of(lattice)
    found = []
    if width < limits.wall:
        message = f"a beam of {width:.3g} mm, expected at least {settings.rules.least_wall_mm:g} mm, at "
        found.append(Violation(LEAST_WALL, name, message + f"{place_words(place)} mm"))
    area = np.pi / 4.0 * width**2
    if area < limits.contact:
        message = f"a beam of {area:.3g} mm2, expected at least {settings.rules.least_contact_mm2:g} mm2, at "
        found.append(Violation(LEAST_CONTACT, name, message + f"{place_words(place)} mm"))
    return found


class _GrantedLimits(NamedTuple):
    """The least wall (mm) and the least contact (mm2), less the tolerance."""

    wall: float
    contact: float

    @property
    def reach(self) -> float:
        """Distance (mm) beyond the centres of discs up to which corners reach."""
        return self.wall / 2.0 + _CORNER * self.wall


def _limits_of(settings: BuildSettings) -> _GrantedLimits:
    wall, contact = settings.rules.least_wall_mm, settings.rules.least_contact_mm2
    return _GrantedLimits(max(wall - TOLERANCE, 0.0), max(contact - 2.0 * TOLERANCE * wall, 0.0))


class _SectionJudge:
    """Judges the supports of a build one after the other."""

    def __init__(self, build: Build, solids: KnownSolids) -> None:
        self.settings, self.solids = build.settings, solids
        self.parts = _PartSolids(build.parts)
        self.limits = _limits_of(build.settings)
        self.shapes = KnownShapes(*self.limits, self.limits.reach)

    def thin_places(self, body: SupportBody) -> ThinPlaces:
        """Return the places where a support is too thin."""
        if not accepted(self.solids.of(body.mesh)):
            return ThinPlaces([], 0)
        heights, sizes = _heights(body), self.settings.sizes_of(body)
        found = self._places_at(body, heights, sizes)
        thin = np.flatnonzero([bool(places) for places in found])
        beside = heights[thin, None] + (-self.burr, self.burr)
        around = self._places_at(body, np.unique(beside), sizes)
        places: list[ThinPlace] = []
        for row, both in zip(thin.tolist(), np.searchsorted(np.unique(beside), beside).tolist(), strict=True):
            others = [place for number in both for place in around[number]]
            places += [place for place in found[row] if _continues(place, others, 3.0 * self.burr)]
        return ThinPlaces(places, len(heights))

    @property
    def burr(self) -> float:
        """Height (mm) up to which what is too thin is a burr, and no wall: the least wall."""
        return max(self.settings.rules.least_wall_mm, _SLIVER)

    def _places_at(self, body: SupportBody, heights: Floats, sizes: SupportSizes) -> list[list[ThinPlace]]:
        """Return the places in each of the sections at ascending heights."""
        outlines = outlines_of(self.solids.sliced(body.mesh).contours(heights), STRAIGHT)
        undecided = self.shapes.undecided(outlines)
        found: list[list[ThinPlace]] = [[] for _ in heights]
        for plane in np.unique(outlines.plane[undecided.own]).tolist():
            own, around = (np.flatnonzero(rows & (outlines.plane == plane)) for rows in undecided)
            region = outlines.region_of(own)
            if not region.is_empty():
                near = outlines.region_of(around)
                section = _Section(region, near, float(heights[plane]), self.limits, sizes, self.parts)
                found[plane] = [*section.small_pieces(), *section.fins()]
        return found


def _continues(place: ThinPlace, others: Sequence[ThinPlace], distance: float) -> bool:
    """Tell whether one of `others` is of the same kind and horizontally within a distance (mm) of a thin place."""
    return any(
        other.promise == place.promise and np.hypot(*(other.position_mm - place.position_mm)[:2]) <= distance
        for other in others
    )


def _heights(body: SupportBody) -> Floats:
    """Return heights for sections, evenly spaced, away from the heights at which vertices are frequent."""
    low, high = (float(corner[2]) for corner in body.mesh.bounds)
    count = int(np.clip(np.ceil((high - low) / _STEP), 2, _MOST_SECTIONS))
    return np.asarray(low + (high - low) * (np.arange(count) + 0.4937) / count)


class _PartSolids:
    """The solids of the parts of a build, each made when it is first needed; a few are kept."""

    def __init__(self, parts: Sequence[PlacedPart]) -> None:
        self.placed = parts
        boxes = [placed.mesh.bounds for placed in parts]
        self.low, self.high = (np.array([box[side] for box in boxes]).reshape(-1, 3) for side in (0, 1))
        self.solid = lru_cache(maxsize=_KEPT)(self._made)

    def near(self, low: Floats, high: Floats) -> list[int]:
        """Return the parts whose boxes meet a box; of a box in plan, ``(2,)``, the height is not compared."""
        axes = slice(len(low))
        meets = (self.low[:, axes] <= high) & (self.high[:, axes] >= low)
        return [int(part) for part in np.flatnonzero(meets.all(axis=1))]

    def _made(self, part: int) -> "Manifold":
        mesh = self.placed[part].mesh
        return as_manifold(mesh.vertices, mesh.triangles)


class _Section:
    """What is to be judged of a horizontal section of a support, and what is around it."""

    def __init__(
        self,
        region: "CrossSection",
        around: "CrossSection",
        height: float,
        limits: _GrantedLimits,
        sizes: SupportSizes,
        parts: "_PartSolids",
    ) -> None:
        self.region, self.around, self.height = region, around, height
        self.parts, self.sizes = parts, sizes
        self.part_sections: dict[int, CrossSection] = {}
        self.limits = limits
        self.wall, self.contact = limits

    def small_pieces(self) -> list[ThinPlace]:
        """Return the pieces that are too narrow or too small, unless they are tips or touch a part."""
        found: list[ThinPlace] = []
        if _all_large(self.region, self.wall, self.contact):
            return found
        for piece in self.region.decompose():
            area, width = piece.area(), _mean_width(piece)
            narrow = width < self.wall and piece.offset(-self.wall / 2.0).is_empty()
            if not (narrow or area < self.contact) or area < _SPECK**2:
                continue
            place = self._place(piece)
            wall, contact = self._limits_at(place)
            if self._touches_part(piece):
                continue
            if narrow and width < wall and piece.offset(-wall / 2.0).is_empty():
                found.append(ThinPlace(LEAST_WALL, width, place))
            if area < contact:
                found.append(ThinPlace(LEAST_CONTACT, area, place))
        return found

    def fins(self) -> list[ThinPlace]:
        """Return what reaches beyond the discs of the least wall farther than corners do."""
        rest = self._beyond_discs(self.region, self.around) if self.wall > 0.0 else None
        if rest is None or rest.area() <= _SPECK:
            return []
        found = []
        for piece in rest.decompose():
            place = self._place(piece)
            if piece.area() <= _SPECK or self._is_alone(piece) or self._limits_at(place)[0] < self.wall:
                continue
            if self._touches_part(piece):
                joined = self.around + self._part(piece)
                together = self._beyond_discs(joined, joined) ^ piece
                if together.area() <= _SPECK or self._touches_part(together):
                    continue
            found.append(ThinPlace(LEAST_WALL, min(_mean_width(piece), self.wall), place, is_fin=True))
        return found

    def _beyond_discs(self, region: "CrossSection", around: "CrossSection") -> "CrossSection":
        """Return what of a region the discs that fit in it and around it leave, apart from corners."""
        from manifold3d import JoinType

        discs = shrunk(around, self.wall / 2.0)
        return region - discs.offset(self.limits.reach, JoinType.Round, 2.0, _SEGMENTS)

    @cached_property
    def _alone(self) -> "CrossSection":
        """The connected pieces in which no disc fits; they are judged as wholes."""
        from manifold3d import CrossSection, OpType

        narrow = [each for each in self.region.decompose() if each.offset(-self.wall / 2.0).is_empty()]
        return CrossSection.batch_boolean(narrow, OpType.Add) if narrow else CrossSection()

    def _is_alone(self, piece: "CrossSection") -> bool:
        return not (self._alone ^ piece).is_empty()

    def _part(self, piece: "CrossSection") -> "CrossSection":
        """Return the section of the parts around a piece."""
        from manifold3d import CrossSection

        low, high = _bounds(piece)
        found = CrossSection()
        for part in self.parts.near(low - 2.0 * self.wall, high + 2.0 * self.wall):
            if part not in self.part_sections:
                self.part_sections[part] = self.parts.solid(part).slice(self.height)
            found += self.part_sections[part]
        return found

    def _touches_part(self, piece: "CrossSection") -> bool:
        return not (piece.offset(_TOUCH) ^ self._part(piece)).is_empty()

    def _place(self, piece: "CrossSection") -> Floats:
        """Return a point of a piece."""
        points = np.asarray(piece.to_polygons()[0])
        return np.append(points.mean(axis=0), self.height)

    def _limits_at(self, place: Floats) -> tuple[float, float]:
        """Return the least wall and the least contact at a place; less for tips, up to their height below a part."""
        least = min(
            (size for size in (self.sizes.tip_width_mm, self.sizes.neck_mm) if size > 0.0), default=0.0
        )
        if least <= 0.0 or self.wall <= _SLIVER or not self._is_tip(place):
            return self.wall, self.contact
        least = min(least, _SLIVER)
        return least, min(self.contact, np.pi / 4.0 * least**2)

    def _is_tip(self, place: Floats) -> bool:
        from manifold3d import Manifold

        height = self.sizes.tip_height_mm + (self.sizes.square_mm if self.sizes.neck_mm else 0.0) + _SLOPE
        size = np.array([self.wall, self.wall, height])
        column = Manifold.cube(size.tolist()).translate(place.tolist())
        return any(
            not (self.parts.solid(part) ^ column).is_empty() for part in self.parts.near(place, place + size)
        )


def _all_large(region: "CrossSection", wall: float, contact: float) -> bool:
    """Tell whether a section has no holes, and each contour is clearly wide and large enough."""
    contours = [np.asarray(contour) for contour in region.to_polygons()]
    if not contours:
        return True
    points = np.concatenate(contours)
    starts = np.cumsum([0, *(len(contour) for contour in contours[:-1])])
    following = np.concatenate([np.roll(contour, -1, axis=0) for contour in contours])
    cross = points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0]
    area = np.add.reduceat(cross, starts) / 2.0
    length = np.add.reduceat(np.hypot(*(following - points).T), starts)
    return bool((area >= contact).all() and (2.0 * area >= wall * length).all() and (area > 0.0).all())


def _mean_width(region: "CrossSection") -> float:
    """Return twice the area over the perimeter, mm: at most the diameter of the largest disc that fits inside."""
    length = 0.0
    for contour in region.to_polygons():
        points = np.asarray(contour)
        length += float(np.hypot(*(points - np.roll(points, -1, axis=0)).T).sum())
    return 2.0 * float(region.area()) / max(length, 1e-12)


def _bounds(region: "CrossSection") -> tuple[Floats, Floats]:
    box = region.bounds()
    return np.asarray(box[:2]), np.asarray(box[2:])
