"""List the overhangs that no support holds, by region and reason."""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Int64s, Ints
from amprep.geometry.meshes.sampling import OverhangSamples, sample_overhangs, triangle_areas
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.model.build import BuildSettings, PlacedPart, SupportBody, Unsupported
from amprep.model.supports.rules import OverhangRules
from amprep.overhangs.contacts import find_held, sample_spacing
from amprep.overhangs.of_part import PartOverhangs

if TYPE_CHECKING:
    from scipy.spatial import KDTree

ReasonsAt = Callable[[int, Floats], Sequence[str]]
"""Returns the reasons for points ``(n, 3)`` mm on a part's unsupported overhangs; called with the part's index."""


def find_unsupported(
    parts: Sequence[PlacedPart],
    overhangs: Sequence[PartOverhangs],
    bodies: Sequence[SupportBody],
    settings: BuildSettings,
    reasons_at: ReasonsAt,
    reach: float | None = None,
) -> tuple[Unsupported, ...]:
    """List the overhangs that have no contact within reach, by part, region and reason.

    Parameters
    ----------
    parts
        The parts of the build.
    overhangs
        The overhangs of each part, as the planner found them.
    bodies
        The finished supports.
    settings
        Reach of bodies that state none, smallest area and smallest length.
    reasons_at
        Says why points are unsupported.
    reach
        Reach (mm) of the supports that the overhangs were to get; None for that of the settings.
    """
    reach = settings.reach if reach is None else reach
    found: list[Unsupported] = []
    for part, (placed, own) in enumerate(zip(parts, overhangs, strict=True)):
        spacing = sample_spacing(placed, bodies, settings)
        samples = sample_overhangs(own.mesh.vertices, own.mesh.triangles, own.overhangs, spacing)
        held = find_held(samples.points, placed.mesh, bodies, settings, spacing)
        left = np.flatnonzero(~held)
        areas = triangle_areas(own.mesh.vertices[own.mesh.triangles[own.overhangs.faces]])
        reasons = np.full(len(held), None, dtype=object)
        reasons[left] = reasons_at(part, samples.points[left])
        for number, chosen_samples in _samples_of_regions(samples, np.unique(samples.region[left])):
            within = _taken(samples, chosen_samples)
            found_region = own.overhangs.regions[number]
            region = _RegionCoverage(within, held[chosen_samples], found_region, areas, settings.rules, reach)
            open_ones = np.flatnonzero(~region.held)
            for reason, minor, chosen in region.patches(open_ones, reasons[chosen_samples][open_ones]):
                found.append(
                    Unsupported(
                        part,
                        region_name(int(number), placed.label),
                        region.region.feature,
                        reason,
                        region.measure(chosen),
                        _thinned(within.points[chosen], reach / 3),
                        reach,
                        minor,
                    )
                )
    return tuple(found)


def _samples_of_regions(samples: OverhangSamples, numbers: Ints) -> Iterator[tuple[int, Ints]]:
    """Yield regions and the indices of their samples; all samples are sorted once, since regions may be thousands."""
    order = np.argsort(samples.region, kind="stable")
    first, end = (np.searchsorted(samples.region[order], numbers, side=side) for side in ("left", "right"))
    for number, start, stop in zip(numbers.tolist(), first, end, strict=True):
        yield number, order[start:stop]


def _taken(samples: OverhangSamples, chosen: Ints) -> OverhangSamples:
    return OverhangSamples(
        samples.points[chosen], samples.region[chosen], samples.inner[chosen], samples.face[chosen]
    )


def region_name(region: int, label: str) -> str:
    """Return the name of an overhang region of a placed part in reports: ``overhang 7 of bracket-2``."""
    return f"overhang {region + 1} of {label}"


class _RegionCoverage(NamedTuple):
    """One overhang region of a part.

    Attributes
    ----------
    samples, held
        The samples of the region, and which of them are held.
    region
        The region.
    areas
        Areas (mm2) of the faces of all overhangs of the part.
    rules, reach
        Rules for what needs support, and the reach of supports, mm.
    """

    samples: OverhangSamples
    held: Bools
    region: OverhangRegion
    areas: Floats
    rules: OverhangRules
    reach: float

    def patches(self, left: Ints, reasons: NDArray[np.object_]) -> Iterator[tuple[str, bool, Ints]]:
        """Yield the samples of the region that are not held by reason, first those that count, then minor ones."""
        minor = self._are_minor(left)
        for reason in sorted(set(reasons)):
            for small in (False, True):
                chosen = left[(reasons == reason) & (minor == small)]
                if len(chosen):
                    yield reason, small, chosen

    def measure(self, chosen: Ints) -> float:
        """Return the area or length of the region that the chosen samples represent."""
        inner, count = self.samples.inner, np.count_nonzero(self.samples.inner)
        if not count:
            return float(self.region.measure * len(chosen) / len(inner))
        lattice_area = self.region.measure / count
        found = np.count_nonzero(inner[chosen])
        return float(lattice_area * found) if found else self._rim_measure(chosen, lattice_area)

    def _rim_measure(self, chosen: Ints, lattice_area: float) -> float:
        """Return the area that samples on rims represent: of triangles without lattice points, or strips beside rims.

        A strip ends half-way to the nearest sample that is held.
        """
        from scipy.spatial import KDTree

        samples = self.samples
        face, count = np.unique(samples.face, return_counts=True)
        at = np.searchsorted(face, samples.face[chosen])
        area = self.areas[samples.face[chosen]] / count[at]
        in_strip = np.isin(samples.face[chosen], samples.face[samples.inner])
        held = samples.points[self.held]
        if in_strip.any() and len(held):
            width = KDTree(held).query(samples.points[chosen[in_strip]])[0] / 2.0
            whole = self.areas[samples.face[chosen[in_strip]]]
            area[in_strip] = np.minimum(width * np.sqrt(lattice_area), whole)
        return float(area.sum())

    def _are_minor(self, left: Ints) -> Bools:
        """Tell which of the samples that are not held are minor.

        A minor patch is smaller than the smallest area (or length), and beside it the part is held at a point
        that is no higher: the part does not start in the air there. A tip is never minor.
        """
        from scipy.spatial import KDTree

        rules, near = self.rules, self.reach / 2
        smallest = {"face": rules.min_area_mm2, "edge": rules.min_length_mm, "tip": 0.0}[self.region.feature]
        minor = np.zeros(len(left), np.bool_)
        points = self.samples.points
        held = points[self.held]
        if smallest <= 0.0 or not len(held):
            return minor
        tree = KDTree(held)
        for own in _patches(points[left], near):
            is_small = self.measure(left[own]) < smallest
            minor[own] = is_small and _is_held_as_low(points[left[own]], tree, near)
        return minor


def _patches(points: Floats, distance: float) -> list[Int64s]:
    """Return the indices of connected points ``(n, 3)``; points at most `distance` mm apart are connected."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    pairs = KDTree(points).query_pairs(distance, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), np.int8), tuple(pairs.T)), shape=(len(points), len(points)))
    label = connected_components(graph, directed=False)[1]
    order = np.argsort(label, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(label[order])) + 1)


def _is_held_as_low(patch: Floats, held: "KDTree", near: float) -> bool:
    """Tell whether a held point within `near` mm of the patch is no higher than the lowest point of the patch."""
    found = held.query_ball_point(patch, near)
    around = np.unique(np.concatenate([np.asarray(each, np.int64) for each in found]))
    lowest = held.data[around, 2].min(initial=np.inf)
    return bool(lowest <= patch[:, 2].min() + CONTACT_TOLERANCE)


def _thinned(points: Floats, cell: float) -> Floats:
    """Return one point of each cell (mm) of a grid."""
    _, first = np.unique(np.floor(points / cell), axis=0, return_index=True)
    return points[np.sort(first)]
