"""Read the beam lattice of a 3MF file: nodes, struts and radii, in millimetres."""

from pathlib import Path

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.errors import InputError
from amprep.threemf.package.open import open_package
from amprep.threemf.read.arrays import fetch_mesh, load_model

MOST_BEAMS = 2000
"""Of one cell."""

_MILLIMETRES = (0.001, 1.0, 10.0, 25.4, 304.8, 1000.0)
"""In the order of lib3mf's `ModelUnit`."""


def read_beams(path: Path) -> tuple[Floats, Ints, Floats] | None:
    """Return the beams of the first object that has any: nodes ``(n, 3)``, struts ``(m, 2)``, radii ``(m, 2)``.

    Returns
    -------
    lattice
        None when the file has no beams.

    Raises
    ------
    InputError
        When the file cannot be read or has too many beams.
    """
    from lib3mf import Lib3MF

    package = open_package(path)
    try:
        loaded = load_model(package.data)
        objects = loaded.model.GetMeshObjects()
        scale = _MILLIMETRES[int(loaded.model.GetUnit())]
        while objects.MoveNext():
            thing = objects.GetCurrentMeshObject()
            lattice = thing.BeamLattice()
            if lattice.GetBeamCount() > MOST_BEAMS:
                raise InputError(f"{path}: {lattice.GetBeamCount()} beams, a cell has at most {MOST_BEAMS}")
            if lattice.GetBeamCount():
                beams = lattice.GetBeams()
                struts = np.array([list(beam.Indices) for beam in beams], np.int32)
                radii = np.array([list(beam.Radii) for beam in beams], np.float64)
                nodes = fetch_mesh(thing).vertices if thing.GetVertexCount() else np.empty((0, 3))
                used, local = np.unique(struts, return_inverse=True)
                return nodes[used] * scale, local.reshape(-1, 2).astype(np.int32), radii * scale
    except Lib3MF.ELib3MFException as error:
        raise InputError(f"{path}: lib3mf cannot read this file ({error})") from error
    return None
