"""Settings of the slicer, which it writes as comments at the beginning and the end of G-code."""

import re

import numpy as np

from amprep.arrays import Floats

_PROGRAM = re.compile(
    r"^;\s*(?:generated (?:by|with)\s+)?((?:PrusaSlicer|SuperSlicer|OrcaSlicer|BambuStudio|Slic3r|Cura)[\w.+-]*"
    r"(?:[ ]+v?[\d.][\w.+-]*)?)",
    re.MULTILINE | re.IGNORECASE,
)
_SETTING = re.compile(r"^; ?([a-z][a-z0-9_ ]{2,60}?)[ \t]*=[ \t]*([^\r\n]{0,20000})", re.MULTILINE)
_CORNER = re.compile(r"(-?\d+(?:\.\d+)?)x(-?\d+(?:\.\d+)?)")
_LARGEST_BED = 1e5


def program_of(head: str) -> str:
    """Return the name and version of the slicer, "" if the beginning of the file does not state it."""
    found = _PROGRAM.search(head)
    return "" if found is None else found[1]


def settings_in(text: str) -> dict[str, str]:
    """Return the settings in comments of the form ``; name = value``."""
    return {name.strip(): value.strip() for name, value in _SETTING.findall(text)}


def bed_of(settings: dict[str, str]) -> Floats:
    """Return the corners of the bed, ``(n, 2)`` mm; empty if the settings do not state it."""
    text = settings.get("bed_shape") or settings.get("printable_area") or ""
    corners = np.array([[float(x), float(y)] for x, y in _CORNER.findall(text)]).reshape(-1, 2)
    if len(corners) < 3 or np.abs(corners).max() > _LARGEST_BED:
        return np.empty((0, 2))
    return corners


def half_width_of(settings: dict[str, str]) -> float:
    """Return half the width of lines (mm) before the file states it, from the width of outer walls or the nozzle."""
    names = (
        *("external perimeters extrusion width", "external_perimeter_extrusion_width"),
        *("outer_wall_line_width", "line_width", "nozzle_diameter"),
    )
    for name in names:
        found = re.match(r"(\d+(?:\.\d+)?)\s*(?:mm)?\s*(?:,|$)", settings.get(name, ""))
        if found and 0.0 < float(found[1]) <= 10.0:
            return float(found[1]) / 2.0
    return 0.2
