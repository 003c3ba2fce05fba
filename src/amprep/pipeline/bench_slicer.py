"""How much support PrusaSlicer prints under a part: its G-code, measured."""

import re
import shutil
import subprocess
import tempfile
from math import pi
from pathlib import Path

from amprep.model import Mesh
from amprep.threemf import write_stl

STYLES = ("grid", "snug", "organic")

FILAMENT_MM = 1.75

_TIME_LIMIT_S = 300
_EXTRUSION = re.compile(r"G1 .*[XY].* E(\d*\.?\d+)")


def find_slicer() -> Path | None:
    """Return PrusaSlicer's executable on the search path, or None."""
    found = shutil.which("prusa-slicer") or shutil.which("PrusaSlicer")
    return None if found is None else Path(found)


def rival_volume(slicer: Path, mesh: Mesh, style: str) -> float | None:
    """Return the volume of the support that PrusaSlicer extrudes under the part, mm3; None if it refuses.

    Supports from the plate only, for faces under 45 degrees and bridges, otherwise PrusaSlicer's defaults: a
    sparse pattern of lines, with a gap below the part. It chooses the contact by its own rules.
    """
    with tempfile.TemporaryDirectory() as folder:
        model, code = Path(folder) / "part.stl", Path(folder) / "part.gcode"
        write_stl(mesh, model)
        options = {
            "support-material-threshold": "45",
            "support-material-style": style,
            "bed-shape": "0x0,250x0,250x210,0x210",
            "filament-diameter": str(FILAMENT_MM),
            "layer-gcode": "G92 E0",
            "output": str(code),
        }
        command = [str(slicer), "--export-gcode", "--support-material", "--support-material-auto"]
        command += [
            "--support-material-buildplate-only",
            "--dont-support-bridges=0",
            "--use-relative-e-distances",
        ]
        command += [word for name, value in options.items() for word in (f"--{name}", value)]
        command.append(str(model))
        ended = subprocess.run(command, capture_output=True, check=False, timeout=_TIME_LIMIT_S)  # noqa: S603 - no shell
        if ended.returncode or not code.exists():
            return None
        return support_in(code.read_text(encoding="utf-8", errors="replace"))


def support_in(gcode: str) -> float:
    """Return the volume that G-code with relative extrusion lays down as support, mm3."""
    length, counts = 0.0, False
    for line in gcode.splitlines():
        if line.startswith(";TYPE:"):
            counts = line.startswith(";TYPE:Support material")
        elif counts and (found := _EXTRUSION.match(line)):
            length += float(found[1])
    return length * pi * FILAMENT_MM**2 / 4
