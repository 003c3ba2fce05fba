"""The report of `amprep lattice`: its records, as JSON and as lines for the terminal."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from amprep.checks.violation import Violation
from amprep.geometry.powder.pockets import Pocket
from amprep.infill.fill_region import FilledPart
from amprep.model import Part
from amprep.model.counting import counted
from amprep.model.summary import Summarised
from amprep.report.json_values import plain, pockets_json, stages_json, violations_json, write_json_file
from amprep.report.record import StageTime

if TYPE_CHECKING:
    from rich.console import RenderableType

_MUCH_TRAPPED = 0.05
"""Fraction of the powder between the cells above which a warning of trapped powder gives advice."""

FORMAT = 1
"""Version of the layout; it increases when a key changes its meaning or is removed."""


@dataclass(frozen=True, eq=False)
class FilledPartRecord:
    """A part in which regions were filled with cells.

    Attributes
    ----------
    part
        The part before filling.
    regions
        Names of the regions.
    filled
        The filled part.
    density_g_cm3
        Density of the material; None if it is unknown.
    pockets
        Powder that cannot leave, largest first, whatever encloses it.
    pockets_before_mm3
        Volume of the pockets before filling.
    """

    part: Part
    regions: tuple[str, ...]
    filled: FilledPart
    density_g_cm3: float | None
    pockets: tuple[Pocket, ...]
    pockets_before_mm3: float
    violations: tuple[Violation, ...]

    @property
    def beams(self) -> int:
        """Number of beams; 0 if cells are solids."""
        return 0 if self.filled.lattice is None else len(self.filled.lattice.struts)

    @property
    def volume_mm3(self) -> float:
        """Volume of the filled part."""
        return self.filled.mesh.signed_volume

    @property
    def trapped_powder_mm3(self) -> float:
        """Volume of powder that the cells trap: that of the pockets after filling less that before."""
        return max(sum(pocket.volume for pocket in self.pockets) - self.pockets_before_mm3, 0.0)

    def mass_g(self, volume_mm3: float) -> float | None:
        """Return the mass of a volume of the material; None if the density is unknown."""
        return None if self.density_g_cm3 is None else volume_mm3 * self.density_g_cm3 / 1000.0


@dataclass(frozen=True, eq=False, repr=False)
class InfillRecord(Summarised):
    """A call of ``amprep lattice``.

    Attributes
    ----------
    size_mm, height_mm
        Size of a cell along x and y, and along z.
    powder_hole_mm
        Powder can leave where a ball of this diameter can.
    unchanged_parts
        Names of the parts without filled regions.
    files
        Names of the written files; empty for a dry run.
    """

    job: str
    version: str
    cell: str
    size_mm: float
    height_mm: float
    powder_hole_mm: float
    parts: tuple[FilledPartRecord, ...]
    unchanged_parts: tuple[str, ...]
    files: tuple[str, ...] = ()
    stages: tuple[StageTime, ...] = ()
    warnings: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Job, cell and counts in one line."""
        filled = f"{len(self.parts)} filled, {len(self.unchanged_parts)} unchanged"
        return f"{self.job}, {self.cell}: {filled}, {counted(self.faults, 'fault')}"

    @property
    def faults(self) -> int:
        """Number of broken promises."""
        return sum(len(part.violations) for part in self.parts)


def to_json(record: InfillRecord) -> dict[str, Any]:
    """Return the record as plain values."""
    result: dict[str, Any] = plain(
        {
            "format": FORMAT,
            "amprep_version": record.version,
            "job": record.job,
            "cell": record.cell,
            "size_mm": record.size_mm,
            "height_mm": record.height_mm,
            "powder_hole_mm": record.powder_hole_mm,
            "parts": [_part(part) for part in record.parts],
            "unchanged_parts": record.unchanged_parts,
            "files": record.files,
            "stages": stages_json(record.stages),
            "warnings": list(warnings_of(record)),
        }
    )
    return result


def write_json(record: InfillRecord, path: Path) -> None:
    """Write the record; the file appears complete, or not at all."""
    write_json_file(to_json(record), path)


def _part(part: FilledPartRecord) -> dict[str, Any]:
    filled = part.filled
    return {
        "name": part.part.name,
        "regions": part.regions,
        "cells": filled.count,
        "beams": part.beams,
        "triangles": len(filled.mesh.triangles),
        "volume_before_mm3": part.part.volume_mm3,
        "volume_after_mm3": part.volume_mm3,
        "region_volume_mm3": filled.region.signed_volume,
        "cell_volume_mm3": filled.cells_mm3,
        "relative_density": filled.density,
        "mass_before_g": part.mass_g(part.part.volume_mm3),
        "mass_after_g": part.mass_g(part.volume_mm3),
        "dropped_components": filled.dropped_components,
        "dropped_volume_mm3": filled.dropped_volume_mm3,
        "genus": filled.genus,
        "trapped_powder_mm3": part.trapped_powder_mm3,
        "pockets": pockets_json(part.pockets),
        "violations": violations_json(part.violations),
    }


def warnings_of(record: InfillRecord) -> Iterator[str]:
    """Yield warnings: those of the run, trapped powder, dropped components and broken promises."""
    yield from record.warnings
    for part in record.parts:
        if part.trapped_powder_mm3 > 0.0:
            yield _trapped_powder_warning(part, record.powder_hole_mm)
        if dropped := part.filled.dropped_components:
            yield (
                f"{part.part.name}: dropped {counted(dropped, 'disconnected component')} of cells "
                f"({part.filled.dropped_volume_mm3:.3g} mm3) that nothing holds"
            )
        for found in part.violations:
            yield f"{part.part.name}: {found.promise}: {found.message}"


def _trapped_powder_warning(part: FilledPartRecord, hole_mm: float) -> str:
    trapped = part.trapped_powder_mm3
    between = part.filled.region.signed_volume - part.filled.cells_mm3
    advice = "; let the region reach the part's surface, or choose a more open cell"
    return (
        f"{part.part.name}: {trapped:.4g} mm3 of powder in {counted(len(part.pockets), 'pocket')} cannot leave, "
        f"{trapped / max(between, trapped):.1%} of the powder between the cells (no opening "
        f"lets a ball of {hole_mm:g} mm escape){advice if trapped > _MUCH_TRAPPED * between else ''}"
    )


def summary(record: InfillRecord) -> "RenderableType":
    """Return figures, warnings, durations and files, ready to print."""
    from rich import box
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    size = f"{record.size_mm:g} x {record.size_mm:g} x {record.height_mm:g} mm"
    title = Text(f"{record.job}: cell {record.cell}, {size}")
    table = Table(box=box.SIMPLE_HEAD, title=title, title_justify="left")
    table.add_column("part")
    for heading in ("cells", "relative density", "volume", "mass", "saved", "verified"):
        table.add_column(heading, justify="right", no_wrap=True)
    for part in record.parts:
        cells, mass = part.filled.count, part.mass_g(part.volume_mm3)
        table.add_row(
            Text(part.part.name),
            f"{cells} ({part.beams} beams)" if part.beams else str(cells),
            f"{part.filled.density:.1%}",
            f"{part.volume_mm3 / 1000:.4g} cm³",
            "-" if mass is None else f"{mass:.4g} g",
            f"{1.0 - part.volume_mm3 / part.part.volume_mm3:.0%}",
            f"no ({len(part.violations)})" if part.violations else "yes",
        )
    lines: list[RenderableType] = [table]
    lines += [Text(f"! {line}", style="yellow") for line in warnings_of(record)]
    durations = ", ".join(f"{stage.name} {stage.seconds:.1f} s" for stage in record.stages)
    lines.append(Text(durations, style="dim"))
    lines += [Text(f"wrote {name}", style="dim") for name in record.files]
    return Group(*lines)
