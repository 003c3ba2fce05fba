"""Read STEP files: OpenCASCADE triangulates them."""

import math
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from amprep.errors import InputError
from amprep.model.part import Part
from amprep.plugins.readers.files import read_gltf
from amprep.plugins.readers.limits import read_bounded
from amprep.validation import require_bounds


@dataclass(frozen=True)
class StepParams:
    """Accuracy of the triangulation of curved faces.

    Attributes
    ----------
    deviation_mm
        Largest distance between a triangle and the face, 0.0001 to 10.
    angle_deg
        Largest angle between neighbouring triangles of a curved face, 1 to 60.
    """

    deviation_mm: float = 0.01
    angle_deg: float = 15.0

    def __post_init__(self) -> None:
        require_bounds(self, "deviation_mm", at_least=1e-4, at_most=10.0)
        require_bounds(self, "angle_deg", at_least=1.0, at_most=60.0)


def read_step_file(path: Path, params: StepParams) -> list[Part]:
    """Return a triangulated part for each solid of a STEP file.

    Raises
    ------
    InputError
        If cascadio is not installed, or OpenCASCADE cannot read the file.
    """
    try:
        import cascadio
    except ImportError as error:
        raise InputError(
            f'{path}: reading STEP files needs cascadio; run: pip install "amprep[step]"'
        ) from error
    content = read_bounded(path)
    if b"ISO-10303-21" not in content[:1024]:
        raise InputError(f"{path}: not a STEP file: it must begin with 'ISO-10303-21'")
    if b"END-ISO-10303-21" not in content[-1024:]:
        raise InputError(f"{path}: the file is incomplete: 'END-ISO-10303-21' is missing at the end")
    with _silent_library():
        glb = cascadio.load(
            content,
            tol_linear=params.deviation_mm,
            tol_angular=math.radians(params.angle_deg),
            use_parallel=False,  # threads would change the order of the triangles
        )
    if not glb:
        raise InputError(f"{path}: OpenCASCADE found no shape in this STEP file; export it again")
    note = f"triangulated by OpenCASCADE to {params.deviation_mm:g} mm and {params.angle_deg:g} degrees"
    return read_gltf(glb, ".glb", path, (note,))


@contextmanager
def _silent_library() -> Iterator[None]:
    """Discard the messages that OpenCASCADE writes to stdout and stderr."""
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
