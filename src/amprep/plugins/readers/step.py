"""Parameters of the mesh readers."""

import math
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from amprep.errors import InputError, JobError
from amprep.model.part import Part
from amprep.plugins.readers.files import read_gltf
from amprep.plugins.readers.limits import read_bounded


@dataclass(frozen=True)
class StepParams:
    """How finely curved faces of a STEP file become triangles.

    Attributes
    ----------
    deviation_mm
        Greatest distance of a triangle from the true face, 0.0001 to 10.
    angle_deg
        Greatest angle between neighbouring triangles on a curved face, 1 to 60.
    """

    deviation_mm: float = 0.01
    angle_deg: float = 15.0

    def __post_init__(self) -> None:
        if not 1e-4 <= self.deviation_mm <= 10.0:
            raise JobError(f"deviation_mm: expected 0.0001 to 10, got {self.deviation_mm}")
        if not 1.0 <= self.angle_deg <= 60.0:
            raise JobError(f"angle_deg: expected 1 to 60, got {self.angle_deg}")


def read_step_file(path: Path, params: StepParams) -> list[Part]:
    """Return a part for each solid of a STEP file, triangulated.

    Raises
    ------
    InputError
        If cascadio is not installed, or OpenCASCADE cannot read the file.
    """
    try:
        import cascadio
    except ImportError as error:
        raise InputError(f'{path}: reading STEP needs an extra; run: pip install "amprep[step]"') from error
    content = read_bounded(path)
    if b"ISO-10303-21" not in content[:1024]:
        raise InputError(f"{path}: not a STEP file: expected it to begin with 'ISO-10303-21'")
    if b"END-ISO-10303-21" not in content[-1024:]:
        raise InputError(f"{path}: the file has no end ('END-ISO-10303-21'); it was cut off")
    with _silent_library():
        glb = cascadio.load(
            content,
            tol_linear=params.deviation_mm,
            tol_angular=math.radians(params.angle_deg),
            use_parallel=False,  # the same file gives the same triangles
        )
    if not glb:
        raise InputError(f"{path}: OpenCASCADE finds no shape in this STEP file")
    note = f"triangulated by OpenCASCADE to {params.deviation_mm:g} mm and {params.angle_deg:g} degrees"
    return read_gltf(glb, ".glb", path, (note,))


@contextmanager
def _silent_library() -> Iterator[None]:
    """Keep OpenCASCADE's own messages off the user's screen and out of ``--json``."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(1), os.dup(2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept[0], 1)
        os.dup2(kept[1], 2)
        for descriptor in (*kept, nowhere):
            os.close(descriptor)
