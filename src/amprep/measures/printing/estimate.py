"""Estimate what a build takes: mass, use of the plate, hours of printing, and cost."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from amprep.geometry.plates.shadow import shadow_of
from amprep.measures.density import build_density, layer_count, part_volume, plate_area, support_volume
from amprep.measures.removability import Removal, totals
from amprep.model import Build, PlacedPart

if TYPE_CHECKING:
    from manifold3d import CrossSection


@dataclass(frozen=True)
class PrintingRates:
    """What duration and cost of a build depend on; the material profile states it.

    Attributes
    ----------
    layer_mm
        Layer height.
    recoating_s
        Seconds for each layer apart from the scanning.
    scan_mm2_s
        Area (mm2) that is scanned in a second.
    heating_h, cooling_h
        Hours before the first and after the last layer.
    hour_price, powder_price_kg
        Price of an hour of the machine and of a kilogram of powder; None if unknown.
    """

    layer_mm: float
    recoating_s: float
    scan_mm2_s: float
    heating_h: float = 0.0
    cooling_h: float = 0.0
    hour_price: float | None = None
    powder_price_kg: float | None = None


@dataclass(frozen=True)
class PrintingEstimate:
    """Mass, use of the plate, duration and cost of a build.

    Attributes
    ----------
    parts_g, supports_g
        Mass of the parts and of the supports; None if the density of one of them is unknown.
    plate_use
        Fraction of the plate that the shadows of the parts cover; forbidden zones are not subtracted from the plate.
    density
        Volume of the parts over plate area times build height, see `amprep.measures.density.build_density`.
    layers
        Number of printed layers, from the plate to the highest point.
    recoating_h
        Hours for all layers apart from the scanning.
    scanning_h
        Hours in which the cross-sections of parts and supports are scanned.
    heating_h, cooling_h
        Hours before the first and after the last layer.
    cost
        Price of the hours and of the powder that is melted; None if a price or the mass is unknown.
    shares
        For each part the fraction of the volume of the build that it has with its supports; hours and cost of a part
        are these fractions of those of the build.
    """

    parts_g: float | None = None
    supports_g: float | None = None
    plate_use: float = 0.0
    density: float = 0.0
    layers: int = 0
    recoating_h: float = 0.0
    scanning_h: float = 0.0
    heating_h: float = 0.0
    cooling_h: float = 0.0
    cost: float | None = None
    shares: tuple[float, ...] = ()

    @property
    def hours(self) -> float:
        """Hours for heating, recoating, scanning and cooling."""
        return self.heating_h + self.recoating_h + self.scanning_h + self.cooling_h

    @property
    def mass_g(self) -> float | None:
        """Mass of parts and supports; None if one of them is unknown."""
        return None if self.parts_g is None or self.supports_g is None else self.parts_g + self.supports_g


def estimate_printing(
    build: Build, densities: Sequence[float | None], removal: Sequence[Removal], rates: PrintingRates
) -> PrintingEstimate:
    """Return the estimate for a build.

    The scanned area is the sum of the cross-sections of all layers: volume over layer height.

    Parameters
    ----------
    build
        The build with its supports.
    densities
        Density (g/cm3) of each part; None if unknown.
    removal
        Figures of each support body, which contain its mass.
    rates
        Layer height, speed and prices.
    """
    volumes = [part_volume(placed) for placed in build.parts]
    layers = layer_count(build, rates.layer_mm)
    scanned = (sum(volumes) + support_volume(build)) / rates.layer_mm
    estimate = PrintingEstimate(
        parts_g=_mass(volumes, densities),
        supports_g=totals(tuple(removal))["mass_g"],
        plate_use=plate_use(build),
        density=build_density(build),
        layers=layers,
        recoating_h=layers * rates.recoating_s / 3600.0,
        scanning_h=scanned / rates.scan_mm2_s / 3600.0,
        heating_h=rates.heating_h if build.parts else 0.0,
        cooling_h=rates.cooling_h if build.parts else 0.0,
        shares=_shares(build, volumes),
    )
    return replace(estimate, cost=_cost(estimate, rates))


def _shares(build: Build, volumes: Sequence[float]) -> tuple[float, ...]:
    """Return the fraction of the volume that each part has with its supports; shared ones count in equal parts."""
    own = list(volumes)
    for body in build.supports:
        for part in body.parts if not body.surface else ():
            own[part] += abs(body.mesh.signed_volume) / len(body.parts)
    whole = sum(own)
    return tuple(each / whole if whole else 0.0 for each in own)


def _cost(estimate: PrintingEstimate, rates: PrintingRates) -> float | None:
    if rates.hour_price is None or rates.powder_price_kg is None or estimate.mass_g is None:
        return None
    return estimate.hours * rates.hour_price + estimate.mass_g / 1000.0 * rates.powder_price_kg


def plate_use(build: Build) -> float:
    """Return the fraction of the plate that the shadows of the parts cover; parts above each other count once."""
    from manifold3d import CrossSection, OpType

    shadows = _shadows(build.parts)
    return CrossSection.batch_boolean(shadows, OpType.Add).area() / plate_area(build) if shadows else 0.0


def _shadows(parts: Sequence[PlacedPart]) -> "list[CrossSection]":
    """Return the shadows of parts; equal parts in equal orientations are projected once."""
    known: dict[tuple[int, bytes], CrossSection] = {}
    placed = []
    for each in parts:
        rotation, mesh = each.matrix[:3, :3], each.part.mesh
        key = id(mesh), rotation.tobytes()
        if key not in known:
            known[key] = shadow_of(mesh.vertices @ rotation.T, mesh.triangles)
        x, y = each.matrix[:2, 3].tolist()
        placed.append(known[key].translate((x, y)))
    return placed


def _mass(volumes: Sequence[float], densities: Sequence[float | None]) -> float | None:
    """Return the mass (g) of volumes (mm3); None if a density is unknown."""
    masses = [
        volume * density / 1000.0
        for volume, density in zip(volumes, densities, strict=True)
        if density is not None
    ]
    return sum(masses) if len(masses) == len(volumes) else None
