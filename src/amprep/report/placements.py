"""The map of placements: one line of a CSV file for each part of each build, for labels, inspection and records."""

import csv
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from amprep.arrays import Floats
from amprep.files import replacing
from amprep.model.build import PlacedPart
from amprep.report.record import BuildRecord, RunRecord

COLUMNS = (
    *("build", "file", "label", "part", "copy", "copies", "part_number", "source", "source_sha256"),
    *("x_mm", "y_mm", "z_mm", "size_x_mm", "size_y_mm", "size_z_mm"),
    *(f"r{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)),
    *("t1_mm", "t2_mm", "t3_mm", "volume_mm3", "mesh_sha256"),
)
"""The columns: see docs/report.md."""

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""Spreadsheets take a text that begins so for a formula."""


def placement_rows(record: RunRecord) -> Iterator[dict[str, Any]]:
    """Yield the row of each placed part; copies of a part are numbered over all builds."""
    seen: Counter[str] = Counter()
    copies = Counter(placed.part.name for entry in record.builds for placed in entry.build.parts)
    for entry in record.builds:
        for placed in entry.build.parts:
            name = placed.part.name
            seen[name] += 1
            yield {
                **_identity(entry, placed),
                "copy": seen[name],
                "copies": copies[name],
                **_position(placed),
            }


def write_placements(record: RunRecord, path: Path) -> None:
    """Write the map; the file appears complete, or not at all.

    Raises
    ------
    AmprepError
        If the file cannot be written.
    """
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(placement_rows(record))


def _identity(entry: BuildRecord, placed: PlacedPart) -> dict[str, Any]:
    part = placed.part
    texts = {
        "build": entry.build.settings.build_id,
        "file": entry.file,
        "label": placed.label,
        "part": part.name,
        "part_number": part.part_number,
        "source": Path(part.source).name,
        "source_sha256": part.source_sha256,
        "mesh_sha256": part.mesh.digest,
    }
    return {key: f"'{text}" if text.startswith(_FORMULA) else text for key, text in texts.items()}


def _position(placed: PlacedPart) -> dict[str, str]:
    low, high = placed.mesh.bounds
    size: Floats = high - low
    numbers = [*low.tolist(), *size.tolist(), *placed.matrix[:3, :3].ravel().tolist()]
    numbers += [*placed.matrix[:3, 3].tolist(), placed.part.volume_mm3]
    return {name: f"{number + 0.0:.9g}" for name, number in zip(COLUMNS[9:-1], numbers, strict=True)}
