"""Run PrusaSlicer on a mesh and measure the support in its G-code."""

import re
import shutil
import subprocess
import tempfile
from math import pi
from pathlib import Path

from amprep.model import Mesh
from amprep.stl import write_stl

STYLES = ("grid", "snug", "organic")
FILAMENT_MM = 1.75

_TIME_LIMIT_S = 300
_EXTRUSION = re.compile(r"G1 .*[XY].* E(\d*\.?\d+)")
_OPTIONS = (
    "--export-gcode",
    "--support-material",
    "--support-material-auto",
    "--support-material-buildplate-only",
    "--dont-support-bridges=0",
    "--use-relative-e-distances",
    "--support-material-threshold=45",
    "--bed-shape=0x0,250x0,250x210,0x210",
    f"--filament-diameter={FILAMENT_MM}",
    "--layer-gcode=G92 E0",
)


def find_slicer() -> Path | None:
    """Return PrusaSlicer's executable on the search path, or None."""
    found = shutil.which("prusa-slicer") or shutil.which("PrusaSlicer")
    return None if found is None else Path(found)


def sliced_support_volume(slicer: Path, mesh: Mesh, style: str) -> float | None:
    """Return the volume of the support that PrusaSlicer extrudes below a part (mm3); None if slicing fails.

    Supports start on the plate only and hold faces below 45 degrees and bridges. All other settings are
    PrusaSlicer's defaults: a sparse pattern of lines with a gap below the part. It chooses the contact itself.

    Parameters
    ----------
    slicer
        The executable.
    mesh
        The part, on the plate.
    style
        One of `STYLES`.
    """
    with tempfile.TemporaryDirectory() as folder:
        model, code = Path(folder) / "part.stl", Path(folder) / "part.gcode"
        write_stl(mesh, model)
        command = [
            str(slicer),
            *_OPTIONS,
            f"--support-material-style={style}",
            f"--output={code}",
            str(model),
        ]
        ended = subprocess.run(command, capture_output=True, check=False, timeout=_TIME_LIMIT_S)  # noqa: S603 - no shell
        if ended.returncode or not code.exists():
            return None
        return support_in(code.read_text(encoding="utf-8", errors="replace"))


def support_in(gcode: str) -> float:
    """Return the volume of the support in G-code with relative extrusion (mm3)."""
    length, is_support = 0.0, False
    for line in gcode.splitlines():
        if line.startswith(";TYPE:"):
            is_support = line.startswith(";TYPE:Support material")
        elif is_support and (found := _EXTRUSION.match(line)):
            length += float(found[1])
    return length * pi * FILAMENT_MM**2 / 4
