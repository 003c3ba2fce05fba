"""The page of an inspection: a 3D view that switches between a part and its bounding volumes, and tables."""

from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from amprep.arrays import Floats
from amprep.files import replacing
from amprep.model.counting import counted
from amprep.report.inspection.compare import compare_makers
from amprep.report.inspection.record import InspectedPart, InspectedVolume, InspectionRecord, fit_words
from amprep.report.inspection.words import (
    contents_words,
    file_words,
    gap_words,
    overhang_words,
    printer_words,
    ratio_words,
    volume_words,
    wall_words,
)
from amprep.report.page.cells import Cell, table
from amprep.report.page.geometry import GeometryPack
from amprep.report.page.html import VIEWER, page_text
from amprep.report.page.view_model import volume_model
from amprep.report.picture.colours import SUPPORT

_PART = "#8fa3b8"
_MARGIN = 10.0
"""Distance of a part from the border of the plate that is drawn below it, mm."""


def write_page(record: InspectionRecord, path: Path) -> None:
    """Write the page as one HTML file without references to other files; it appears complete, or not at all."""
    with replacing(path) as temporary:
        temporary.write_bytes(inspection_page(record).encode("utf-8", "replace"))


def inspection_page(record: InspectionRecord) -> str:
    """Return the whole page."""
    pack = GeometryPack()
    shown = [_view(each, pack) for each in record.parts if each.contents is not None]
    model = {"alone": True, "builds": shown, "meshes": pack.entries}
    parts = "".join(_part(each) for each in record.parts)
    body = f"{_header(record)}{VIEWER}{_makers(record)}{parts}{_footer(record)}"
    return page_text(f"{record.name} - amprep inspection", body, model, pack.base64())


def _view(each: InspectedPart, pack: GeometryPack) -> dict[str, Any]:
    """Return the data of the 3D view of one part: it lies in the middle of a plate that is a little larger."""
    low, high = each.part.mesh.bounds
    plate = 10.0 * np.ceil((high - low + 2.0 * _MARGIN) / 10.0)
    shift = np.eye(4)
    shift[:3, 3] = [*(plate[:2] / 2.0 - (low + high)[:2] / 2.0), -low[2]]
    size = [*plate[:2].tolist(), float(high[2] - low[2])]
    return {
        "id": each.name,
        "height": size[2],
        "space": {"size": size, "shape": "box", "zones": []},
        "supportColour": SUPPORT,
        "parts": [_shown_part(each, shift, pack)],
        "supports": [],
        "marks": [],
        "volumes": [choice for volume in each.volumes for choice in _choice(volume, shift, pack)],
    }


def _shown_part(each: InspectedPart, shift: Floats, pack: GeometryPack) -> dict[str, Any]:
    words = [] if each.contents is None else list(contents_words(each.part, each.contents))
    return {
        "name": each.name,
        "colour": _PART,
        "mesh": pack.add(each.part.mesh),
        "matrix": shift.ravel().tolist(),
        "facts": [f"{name}: {value}" for name, value in words[:5]],
    }


def _choice(volume: InspectedVolume, shift: Floats, pack: GeometryPack) -> Iterator[dict[str, Any]]:
    if volume.made is None:
        return
    back = np.eye(4)
    back[:3, :3] = volume.made.rotation.T
    facts = volume_words(volume).split(", ")
    shown = volume_model(volume.made.volume, shift @ back, pack, volume.makers, facts)
    yield {"name": volume.makers, "shown": [shown]}


def _header(record: InspectionRecord) -> str:
    faults = record.faults
    words = counted(faults, "problem") if faults else "nothing wrong"
    chip = f'<span class="chip{" bad" if faults else ""}">{words}</span>'
    files = "".join(
        f'<p class="lead">{"Cannot be read: " if file.problem else ""}{escape(file_words(file))}</p>'
        for file in record.files
    )
    return f"<header><h1>{escape(record.name)}{chip}</h1>\n{files}</header>\n"


def _makers(record: InspectionRecord) -> str:
    """Return a table of the volume makers over all parts; empty for a single part."""
    figures = compare_makers(record)
    if len(record.parts) < 2 or not figures:
        return ""
    headings = ("Volume maker", "Mean ratio|", "Greatest ratio|", "Mean seconds|", "Outside|", "Not made|")
    rows = (
        (
            each.makers,
            ("number", "-" if each.ratio is None else f"{each.ratio:.3f}"),
            ("number", "-" if each.greatest_ratio is None else f"{each.greatest_ratio:.3f}"),
            ("number", f"{each.seconds:.3f}"),
            each.outside,
            each.not_made,
        )
        for each in figures
    )
    title = f"Bounding volumes over {counted(len(record.parts), 'part')}"
    return f"<section><h2>{title}</h2>{table(headings, rows)}</section>\n"


def _part(each: InspectedPart) -> str:
    remarks = [f'<li class="bad">{escape(text)}</li>' for text in each.problems]
    remarks += [f"<li>{escape(text)}</li>" for text in each.findings]
    listed = (
        f'<ul class="remarks">{"".join(remarks)}</ul>' if remarks else '<p class="empty">Nothing wrong.</p>'
    )
    sections = [f"<section><h2>{escape(each.name)}</h2>{listed}"]
    if each.contents is not None:
        figures = [*contents_words(each.part, each.contents), *wall_words(each.walls)]
        sections.append(table(("Figure", "Value"), figures))
    if each.overhangs is not None:
        sections.append(f"<h3>Overhangs at {each.overhangs.angle_deg:g}°</h3>")
        sections.append(table(("Verdict", "Amount"), overhang_words(each.overhangs)))
    if each.printers:
        sections.append(f"<h3>Printers</h3>{table(('Fit', 'Printers'), printer_words(each))}")
    if each.volumes:
        sections.append(f"<h3>Bounding volumes</h3>{_volumes(each)}")
    return "".join(sections) + "</section>\n"


def _volumes(each: InspectedPart) -> str:
    headings = (
        "Volume maker",
        "Ratio|",
        "Kind",
        "Pieces|",
        "Triangles|",
        "Seconds|",
        "Gap|",
        "Judge",
        "Picture",
    )
    return table(headings, (_row(volume) for volume in each.volumes))


def _row(volume: InspectedVolume) -> tuple[Cell, ...]:
    if volume.made is None:
        return (volume.makers, *("",) * 6, volume.failure, "")
    verdict = "; ".join(found.message for found in volume.violations) or volume.verdict
    return (
        volume.makers,
        ("number", ratio_words(volume)),
        volume.kind,
        volume.pieces,
        volume.triangles,
        ("number", f"{volume.seconds:.3f}"),
        ("number", gap_words(volume)),
        verdict,
        volume.picture,
    )


def _footer(record: InspectionRecord) -> str:
    fits = [fit for each in record.parts for fit in each.printers]
    room = f" A part fits a printer with {fit_words(fits)}." if fits else ""
    return (
        f"<footer>Made by amprep {escape(record.version)}.{room} The ratio is "
        "the volume of the bounding volume over that of the part.</footer>\n"
    )
