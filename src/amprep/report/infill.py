"""The report of `amprep lattice`: its records, as JSON and as lines for the terminal."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from amprep.checks.violation import Violation
from amprep.geometry.powder.pockets import Pocket
from amprep.report.counting import counted
from amprep.report.json_values import plain, pockets_json, stages_json, violations_json, write_json_file
from amprep.report.record import StageTime

if TYPE_CHECKING:
    from rich.console import RenderableType

_MUCH_TRAPPED = 0.05
"""Fraction of the powder between the cells above which a warning of trapped powder gives advice."""

FORMAT = 1
"""Version of the layout; it increases when a key changes its meaning or is removed."""


@dataclass(frozen=True)
class FilledPartRecord:
    """A part in which regions were filled with cells.

    Attributes
    ----------
    regions
        Names of the regions.
    cells, beams
        Number of cells, and of beams; 0 beams if cells are solids.
    volume_before_mm3, volume_after_mm3, region_volume_mm3, cell_volume_mm3
        Volume of the part before and after; of the material that the cells replaced, and of the cells.
    mass_before_g, mass_after_g
        None if the density is unknown.
    dropped_components, dropped_volume_mm3
        Disconnected components of cells, which nothing holds; they were removed.
    genus
        Genus of the part's surfaces.
    pockets
        Powder that cannot leave, largest first, whatever encloses it.
    pockets_before_mm3
        Volume of the pockets before filling.
    """

    name: str
    regions: tuple[str, ...]
    cells: int
    beams: int
    triangles: int
    volume_before_mm3: float
    volume_after_mm3: float
    region_volume_mm3: float
    cell_volume_mm3: float
    mass_before_g: float | None
    mass_after_g: float | None
    dropped_components: int
    dropped_volume_mm3: float
    genus: int
    pockets: tuple[Pocket, ...]
    pockets_before_mm3: float
    violations: tuple[Violation, ...]

    @property
    def relative_density(self) -> float:
        """Fraction of the region that the cells fill."""
        return self.cell_volume_mm3 / self.region_volume_mm3

    @property
    def trapped_powder_mm3(self) -> float:
        """Volume of powder that the cells trap: that of the pockets after filling less that before."""
        return max(sum(pocket.volume for pocket in self.pockets) - self.pockets_before_mm3, 0.0)


@dataclass(frozen=True)
class InfillRecord:
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
            "unchanged_parts": list(record.unchanged_parts),
            "files": list(record.files),
            "stages": stages_json(record.stages),
            "warnings": list(warnings_of(record)),
        }
    )
    return result


def write_json(record: InfillRecord, path: Path) -> None:
    """Write the record; the file appears complete, or not at all."""
    write_json_file(to_json(record), path)


def _part(part: FilledPartRecord) -> dict[str, Any]:
    return {
        "name": part.name,
        "regions": list(part.regions),
        "cells": part.cells,
        "beams": part.beams,
        "triangles": part.triangles,
        "volume_before_mm3": part.volume_before_mm3,
        "volume_after_mm3": part.volume_after_mm3,
        "region_volume_mm3": part.region_volume_mm3,
        "cell_volume_mm3": part.cell_volume_mm3,
        "relative_density": part.relative_density,
        "mass_before_g": part.mass_before_g,
        "mass_after_g": part.mass_after_g,
        "dropped_components": part.dropped_components,
        "dropped_volume_mm3": part.dropped_volume_mm3,
        "genus": part.genus,
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
        if part.dropped_components:
            yield (
                f"{part.name}: dropped {counted(part.dropped_components, 'disconnected component')} of cells "
                f"({part.dropped_volume_mm3:.3g} mm3) that nothing holds"
            )
        for found in part.violations:
            yield f"{part.name}: {found.promise}: {found.message}"


def _trapped_powder_warning(part: FilledPartRecord, hole_mm: float) -> str:
    trapped = part.trapped_powder_mm3
    between = part.region_volume_mm3 - part.cell_volume_mm3
    advice = "; let the region reach the part's surface, or choose a more open cell"
    return (
        f"{part.name}: {trapped:.4g} mm3 of powder in {counted(len(part.pockets), 'pocket')} cannot leave, "
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
        table.add_row(
            Text(part.name),
            f"{part.cells} ({part.beams} beams)" if part.beams else str(part.cells),
            f"{part.relative_density:.1%}",
            f"{part.volume_after_mm3 / 1000:.4g} cm³",
            "-" if part.mass_after_g is None else f"{part.mass_after_g:.4g} g",
            f"{1.0 - part.volume_after_mm3 / part.volume_before_mm3:.0%}",
            f"no ({len(part.violations)})" if part.violations else "yes",
        )
    lines: list[RenderableType] = [table]
    lines += [Text(f"! {line}", style="yellow") for line in warnings_of(record)]
    durations = ", ".join(f"{stage.name} {stage.seconds:.1f} s" for stage in record.stages)
    lines.append(Text(durations, style="dim"))
    lines += [Text(f"wrote {name}", style="dim") for name in record.files]
    return Group(*lines)
