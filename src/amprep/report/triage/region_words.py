"""Sum up regions of overhangs of one kind in words."""

from collections.abc import Sequence

from amprep.geometry.overhangs.regions import OverhangRegion
from amprep.model.counting import counted


def regions_in_words(regions: Sequence[OverhangRegion]) -> str:
    """Return number, sizes and limit of regions of one kind, for example ``12 bores 3.0 to 4.2 mm, limit 8 mm``."""
    noun = "knife edge" if regions[0].kind == "edge" else regions[0].kind
    limits = {region.limit_mm for region in regions}
    limit = f"limit {max(limits):g} mm" if len(limits) == 1 and max(limits) > 0.0 else ""
    return ", ".join(filter(None, (f"{counted(len(regions), noun)} {_sizes(regions)}".rstrip(), limit)))


def kinds_in_words(regions: Sequence[OverhangRegion]) -> str:
    """Return what `regions_in_words` says of each kind, the kind with the most regions first; none without regions."""
    kinds = sorted({region.kind for region in regions})
    groups = [[region for region in regions if region.kind == kind] for kind in kinds]
    return "; ".join(regions_in_words(group) for group in sorted(groups, key=len, reverse=True)) or "none"


def _sizes(regions: Sequence[OverhangRegion]) -> str:
    """Return the range of sizes; of the areas or lengths where the kind has no size; empty for tips."""
    sizes = [region.size_mm for region in regions if region.size_mm > 0.0]
    if sizes:
        return _range(sizes, "mm")
    measures = [region.measure for region in regions if region.measure > 0.0]
    return _range(measures, "mm long" if regions[0].kind == "edge" else "mm²") if measures else ""


def _range(values: Sequence[float], unit: str) -> str:
    first, last = f"{min(values):.1f}", f"{max(values):.1f}"
    return f"{first} {unit}" if first == last else f"{first} to {last} {unit}"
