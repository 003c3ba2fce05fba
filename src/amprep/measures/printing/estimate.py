"""Estimate what a build takes: mass, use of the plate, and hours of printing."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING

from amprep.geometry.plates.shadow import shadow_of
from amprep.measures.density import build_density, build_height, part_volume, plate_area, support_volume
from amprep.measures.removability import Removal, totals
from amprep.model import Build, PlacedPart

if TYPE_CHECKING:
    from manifold3d import CrossSection

_ROUNDING = 1e-6
"""Fraction of a layer that rounding may add to the height of a build."""


@dataclass(frozen=True)
class PrintingSpeed:
    """What the duration of a build depends on; the material profile states it.

    Attributes
    ----------
    layer_mm
        Layer height.
    recoating_s
        Seconds for each layer apart from the scanning.
    scan_mm2_s
        Area (mm2) that is scanned in a second.
    """

    layer_mm: float
    recoating_s: float
    scan_mm2_s: float


@dataclass(frozen=True)
class PrintingEstimate:
    """Mass, use of the plate and duration of a build.

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
    """

    parts_g: float | None = None
    supports_g: float | None = None
    plate_use: float = 0.0
    density: float = 0.0
    layers: int = 0
    recoating_h: float = 0.0
    scanning_h: float = 0.0

    @property
    def hours(self) -> float:
        """Hours for recoating and scanning; warming up and cooling down are not included."""
        return self.recoating_h + self.scanning_h

    @property
    def mass_g(self) -> float | None:
        """Mass of parts and supports; None if one of them is unknown."""
        return None if self.parts_g is None or self.supports_g is None else self.parts_g + self.supports_g


def estimate_printing(
    build: Build, densities: Sequence[float | None], removal: Sequence[Removal], speed: PrintingSpeed
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
    speed
        Layer height and speed of the printer.
    """
    volumes = [part_volume(placed) for placed in build.parts]
    layers = max(ceil(build_height(build) / speed.layer_mm - _ROUNDING), 0)
    scanned = (sum(volumes) + support_volume(build)) / speed.layer_mm
    return PrintingEstimate(
        parts_g=_mass(volumes, densities),
        supports_g=totals(tuple(removal))["mass_g"],
        plate_use=plate_use(build),
        density=build_density(build),
        layers=layers,
        recoating_h=layers * speed.recoating_s / 3600.0,
        scanning_h=scanned / speed.scan_mm2_s / 3600.0,
    )


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
