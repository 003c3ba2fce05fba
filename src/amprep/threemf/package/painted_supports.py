"""Find the painted supports that slicers store as attributes of triangles.

PrusaSlicer stores them in ``slic3rpe:custom_supports``, Bambu Studio and OrcaSlicer in ``paint_supports``.
lib3mf passes neither of them on, so that they are read from the XML text.
"""

import re
from typing import NamedTuple

_ELEMENT = re.compile(rb"<(?:\w+:)?(object|triangle)\b((?:[^<>\"']|\"[^\"]*\"|'[^']*')*)>")
_ID = re.compile(rb"(?:^|\s)id\s*=\s*[\"'](\d{1,9})[\"']")
_CODE = re.compile(rb"(?:custom_supports|paint_supports)\s*=\s*[\"']([0-9A-Fa-f]+)[\"']")


class PaintedSupports(NamedTuple):
    """Painted supports of one object.

    Attributes
    ----------
    triangles
        Number of triangles of the object.
    codes
        Index of each painted triangle -> its attribute, see `amprep.threemf.read.painted_supports`.
    """

    triangles: int
    codes: dict[int, str]


def find_painted_supports(model: bytes) -> dict[int, PaintedSupports]:
    """Return object id -> its painted supports, from the text of a model part that has been scanned."""
    found: dict[int, PaintedSupports] = {}
    if b"_supports" not in model:
        return found
    object_id, count, codes = -1, 0, dict[int, str]()
    for element in _ELEMENT.finditer(model):
        if element[1] == b"object":
            match = _ID.search(element[2])
            object_id, count, codes = int(match[1]) if match else -1, 0, {}
            continue
        code = _CODE.search(element[2])
        if code:
            codes[count] = code[1].decode("ascii")
        count += 1
        if codes:
            found[object_id] = PaintedSupports(count, codes)
    return found
