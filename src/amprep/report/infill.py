"""What filling regions with cells came to: the record, as JSON and as lines for the terminal."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from amprep.checks.violation import Violation
from amprep.files import replacing
from amprep.geometry.powder.pockets import Pocket
from amprep.report.json_report import NUMBERS, plain
from amprep.report.record import StageTime

if TYPE_CHECKING:
    from rich.console import RenderableType

_MUCH = 0.05
"""Share of the powder between the cells that has to be locked in before advice is given."""

FORMAT = 1
"""Version of the layout; grows when a key changes its meaning or goes."""


@dataclass(frozen=True)
class FilledRecord:
    """One part that was filled.

    Attributes
    ----------
    regions
        Names of the regions.
    cells, beams
        How many there are; no beams where cells are solids.
    before_mm3, after_mm3, region_mm3, cells_mm3
        The part as it was and as it is; what the cells replaced, and what they fill of it.
    before_g, after_g
        None where the density is not known.
    islands, islands_mm3
        Pieces of cells that nothing held, and so were dropped.
    genus
        How many handles its surfaces have.
    pockets
        Powder that cannot leave, largest first, whatever locks it in; `before` is what the part as it was locks in.
    """

    name: str
    regions: tuple[str, ...]
    cells: int
    beams: int
    triangles: int
    before_mm3: float
    after_mm3: float
    region_mm3: float
    cells_mm3: float
    before_g: float | None
    after_g: float | None
    islands: int
    islands_mm3: float
    genus: int
    pockets: tuple[Pocket, ...]
    pockets_before_mm3: float
    violations: tuple[Violation, ...]

    @property
    def density(self) -> float:
        """Share of the region that the cells fill."""
        return self.cells_mm3 / self.region_mm3

    @property
    def trapped_mm3(self) -> float:
        """Powder that the cells lock in: what cannot leave now, less what could not before."""
        return max(sum(pocket.volume for pocket in self.pockets) - self.pockets_before_mm3, 0.0)


@dataclass(frozen=True)
class LatticeRecord:
    """One call of ``amprep lattice``.

    Attributes
    ----------
    size_mm, height_mm
        Of a cell along x and y, and along z.
    hole_mm
        Powder is loose where a ball of this diameter can leave.
    files
        Names of what was written; empty for a dry run.
    """

    job: str
    version: str
    cell: str
    size_mm: float
    height_mm: float
    hole_mm: float
    parts: tuple[FilledRecord, ...]
    untouched: tuple[str, ...]
    files: tuple[str, ...] = ()
    stages: tuple[StageTime, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def faults(self) -> int:
        """How many promises are broken."""
        return sum(len(part.violations) for part in self.parts)


def to_json(record: LatticeRecord) -> dict[str, Any]:
    """Return the record as plain values."""
    result: dict[str, Any] = plain(
        {
            "format": FORMAT,
            "amprep": record.version,
            "job": record.job,
            "cell": record.cell,
            "size_mm": record.size_mm,
            "height_mm": record.height_mm,
            "hole_mm": record.hole_mm,
            "parts": [_part(part) for part in record.parts],
            "untouched": list(record.untouched),
            "files": list(record.files),
            "stages": [{"name": stage.name, "seconds": round(stage.seconds, 3)} for stage in record.stages],
            "warnings": list(warnings_of(record)),
        }
    )
    return result


def write_json(record: LatticeRecord, path: Path) -> None:
    """Write the record; the file is whole or not there."""
    text = json.dumps(to_json(record), indent=2, ensure_ascii=False, allow_nan=False)
    text = NUMBERS.sub(lambda found: " ".join(found[0].split()), text) + "\n"
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode("utf-8", "backslashreplace"))


def _part(part: FilledRecord) -> dict[str, Any]:
    return {
        "name": part.name,
        "regions": list(part.regions),
        "cells": part.cells,
        "beams": part.beams,
        "triangles": part.triangles,
        "before_mm3": part.before_mm3,
        "after_mm3": part.after_mm3,
        "region_mm3": part.region_mm3,
        "cells_mm3": part.cells_mm3,
        "density": part.density,
        "before_g": part.before_g,
        "after_g": part.after_g,
        "islands": part.islands,
        "islands_mm3": part.islands_mm3,
        "genus": part.genus,
        "trapped_mm3": part.trapped_mm3,
        "pockets": [
            {
                "volume_mm3": pocket.volume,
                "position_mm": pocket.point,
                "low_mm": pocket.lo,
                "high_mm": pocket.hi,
                "closed": pocket.closed,
            }
            for pocket in part.pockets
        ],
        "violations": [
            {"promise": found.promise, "subject": found.subject, "message": found.message}
            for found in part.violations
        ],
    }


def warnings_of(record: LatticeRecord) -> Iterator[str]:
    """Yield what a person should know: powder that cannot leave, cells dropped, parts left alone."""
    yield from record.warnings
    for part in record.parts:
        if part.trapped_mm3 > 0.0:
            advice = "; let the region reach the part's surface, or choose a more open cell"
            free = part.region_mm3 - part.cells_mm3
            yield (
                f"{part.name}: {part.trapped_mm3:.4g} mm3 of powder in {len(part.pockets)} pockets cannot leave, "
                f"{part.trapped_mm3 / max(free, part.trapped_mm3):.1%} of what is between the cells (a ball of "
                f"{record.hole_mm:g} mm finds no way out){advice if part.trapped_mm3 > _MUCH * free else ''}"
            )
        if part.islands:
            yield (
                f"{part.name}: {part.islands} loose pieces of cells ({part.islands_mm3:.3g} mm3) were dropped: "
                "nothing held them"
            )
        for found in part.violations:
            yield f"{part.name}: {found.promise}: {found.message}"


def summary(record: LatticeRecord) -> "RenderableType":
    """Return the figures, what needs a look and the files, ready to print."""
    from rich import box
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, title=Text(f"{record.job}: {_cells(record)}"), title_justify="left")
    table.add_column("part")
    for heading in ("cells", "density", "volume", "mass", "less", "verified"):
        table.add_column(heading, justify="right", no_wrap=True)
    for part in record.parts:
        table.add_row(
            Text(part.name),
            f"{part.cells} ({part.beams} beams)" if part.beams else str(part.cells),
            f"{part.density:.1%}",
            f"{part.after_mm3 / 1000:.4g} cm³",
            "-" if part.after_g is None else f"{part.after_g:.4g} g",
            f"{1.0 - part.after_mm3 / part.before_mm3:.0%}",
            f"no ({len(part.violations)})" if part.violations else "yes",
        )
    lines: list[RenderableType] = [table]
    lines += [Text(f"! {line}", style="yellow") for line in warnings_of(record)]
    times = ", ".join(f"{stage.name} {stage.seconds:.1f} s" for stage in record.stages)
    lines.append(Text(times, style="dim"))
    lines += [Text(f"wrote {name}", style="dim") for name in record.files]
    return Group(*lines)


def _cells(record: LatticeRecord) -> str:
    return f"cells of {record.cell}, {record.size_mm:g} x {record.size_mm:g} x {record.height_mm:g} mm"
