"""The page of a search for orientations: a 3D view that switches between them, pictures and tables."""

from base64 import b64encode
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from amprep.files import replacing
from amprep.model.mesh import Mesh
from amprep.report.orientation.picture import OVERHANG, PART, ShownOrientation
from amprep.report.orientation.record import OrientationRecord, OrientedPart
from amprep.report.orientation.terminal import HEADINGS, cells, rows
from amprep.report.page.cells import Cell, table
from amprep.report.page.geometry import GeometryPack
from amprep.report.page.html import VIEWER, page_text
from amprep.report.picture.colours import SUPPORT

_MARGIN = 10.0
"""Distance of a part from the border of the plate that is drawn below it, mm."""


def write_page(
    record: OrientationRecord,
    shown: Sequence[Sequence[ShownOrientation]],
    pictures: Sequence[bytes],
    path: Path,
) -> None:
    """Write the page as one HTML file without references to other files; it appears complete, or not at all.

    Parameters
    ----------
    record
        The parts with their proposals.
    shown, pictures
        The orientations of each part, and their picture as PNG.
    path
        The file.
    """
    pack = GeometryPack()
    views = [_view(part, each, pack) for part, own in zip(record.parts, shown, strict=True) for each in own]
    model = {"alone": True, "builds": views, "meshes": pack.entries}
    sections = (_part(part, picture) for part, picture in zip(record.parts, pictures, strict=True))
    body = f"{_header(record)}{VIEWER}{''.join(sections)}"
    text = page_text(f"{record.name} - amprep orient", body, model, pack.base64())
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode("utf-8", "replace"))


def _view(part: OrientedPart, each: ShownOrientation, pack: GeometryPack) -> dict[str, Any]:
    """Return the data of the 3D view of one orientation: it lies in the middle of a plate that is a little larger."""
    low, high = each.mesh.bounds
    plate = 10.0 * np.ceil((high - low + 2.0 * _MARGIN) / 10.0)
    shift = np.eye(4)
    shift[:2, 3] = plate[:2] / 2.0 - (low + high)[:2] / 2.0
    shapes: list[tuple[str, str, Mesh]] = [(part.name, PART, each.mesh)]
    if len(each.overhangs.triangles):
        shapes.append(("faces that need support", OVERHANG, each.overhangs))
    size = [*plate[:2].tolist(), float(high[2])]
    return {
        "id": f"{part.name}, {each.name}",
        "height": size[2],
        "space": {"size": size, "shape": "box", "zones": []},
        "supportColour": SUPPORT,
        "parts": [
            {
                "name": name,
                "colour": colour,
                "mesh": pack.add(mesh),
                "matrix": shift.ravel().tolist(),
                "facts": [],
            }
            for name, colour, mesh in shapes
        ],
        "supports": [],
        "marks": [],
        "volumes": [],
    }


def _header(record: OrientationRecord) -> str:
    words = f"{record.printer}, {record.material}, {record.lift_mm:g} mm above the plate"
    return f"<header><h1>{escape(record.name)}</h1>\n<p class=lead>{escape(words)}</p></header>\n"


def _part(part: OrientedPart, picture: bytes) -> str:
    headings = ("", *(f"{heading}|" for heading in HEADINGS), "best by")
    image = b64encode(picture).decode("ascii")
    return (
        f"<section><h2>{escape(part.name)}</h2>\n<p>{part.tried} directions were tried. Faces that need support are "
        f'red.</p>\n<img alt="proposed orientations" style="max-width:100%" src="data:image/png;base64,{image}">\n'
        f"{table(headings, _rows(part))}</section>\n"
    )


def _rows(part: OrientedPart) -> Iterator[tuple[Cell, ...]]:
    for name, proposal in rows(part):
        numbers: list[Cell] = [("number", escape(cell)) for cell in cells(proposal)]
        yield (name, *numbers, ", ".join(proposal.merits))
