"""Lists what nothing holds: by region and reason, and what of it is too small to matter."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats, Ints
from amprep.geometry.meshes.sampling import OverhangSamples
from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.model.build import BuildSettings, Unsupported

ReasonsOf = Callable[[Floats], Sequence[str]]


def list_bare(
    part: int,
    label: str,
    samples: OverhangSamples,
    regions: Sequence[OverhangRegion],
    covered: Bools,
    settings: BuildSettings,
    reasons_of: ReasonsOf,
) -> Iterator[Unsupported]:
    """Yield the samples of a part that are not `covered`, by region, reason and whether they are minor.

    Minor is a connected patch smaller than the least area (a stretch shorter than the least length) that the
    job asks to support, next to held surface that lies no higher: nothing there starts in the air. A tip is
    never minor.
    """
    bare = np.flatnonzero(~covered)
    reasons = np.array(reasons_of(samples.points[bare]), dtype=object)
    for region in np.unique(samples.region[bare]):
        here = samples.region[bare] == region
        minor = _minor(bare[here], samples, regions[region], covered, settings)
        for reason in sorted(set(reasons[here])):
            for small in (False, True):
                chosen = bare[here][(reasons[here] == reason) & (minor == small)]
                if len(chosen):
                    measure = _measure(chosen, samples, regions[region])
                    name = region_name(int(region), label)
                    points = _thinned(samples.points[chosen], settings.reach / 3)
                    kind = regions[region].kind
                    yield Unsupported(part, name, kind, reason, measure, points, settings.reach, small)


def region_name(region: int, label: str) -> str:
    """Return what people call an overhang region of a placed part: ``overhang 7 of bracket-2``."""
    return f"overhang {region + 1} of {label}"


def _minor(
    bare: Ints, samples: OverhangSamples, region: OverhangRegion, covered: Bools, settings: BuildSettings
) -> Bools:
    """Tell which of the bare samples of one region are minor."""
    least = {"face": settings.rules.min_area_mm2, "edge": settings.rules.min_length_mm, "tip": 0.0}[
        region.kind
    ]
    minor = np.zeros(len(bare), np.bool_)
    if least <= 0.0:
        return minor
    patch = _patches(samples.points[bare], settings.reach / 2)
    held = samples.points[covered & (samples.region == samples.region[bare[0]])]
    for number in range(int(patch.max(initial=-1)) + 1):
        own = patch == number
        small = _measure(bare[own], samples, region) < least
        minor[own] = small and _stands(samples.points[bare[own]], held, settings.reach / 2)
    return minor


def _measure(chosen: Ints, samples: OverhangSamples, region: OverhangRegion) -> float:
    """Return the share of the region's area or length that the chosen samples stand for."""
    own = samples.region == samples.region[chosen[0]]
    weight = samples.inner if samples.inner[own].any() else np.ones(len(own), np.bool_)
    return float(region.measure * weight[chosen].sum() / weight[own].sum())


def _patches(points: Floats, apart: float) -> Ints:
    """Label points ``(n, 3)`` so that those at most `apart` mm from one another have one label."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    pairs = KDTree(points).query_pairs(apart, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), np.int8), tuple(pairs.T)), shape=(len(points), len(points)))
    return np.asarray(connected_components(graph, directed=False)[1])


def _stands(patch: Floats, held: Floats, near: float) -> bool:
    """Tell whether some held point near the patch is as low as its lowest."""
    from scipy.spatial import KDTree

    if not len(held):
        return False
    distance, _ = KDTree(patch).query(held, distance_upper_bound=near)
    lowest = held[np.isfinite(distance), 2].min(initial=np.inf)
    return bool(lowest <= patch[:, 2].min() + CONTACT_TOLERANCE)


def _thinned(points: Floats, cell: float) -> Floats:
    """Return one point of each cell of a grid."""
    _, first = np.unique(np.floor(points / cell), axis=0, return_index=True)
    return points[np.sort(first)]
