"""Read the beam lattice of a 3MF file: nodes, struts and radii, in millimetres."""

from pathlib import Path

import numpy as np

from amprep.arrays import Floats, Ints
from amprep.errors import InputError
from amprep.threemf.package.open import open_package
from amprep.threemf.read.arrays import fetch_beams, fetch_mesh, load_model, unit_of

MOST_BEAMS = 2000
"""Largest number of beams of a cell."""


def read_beams(path: Path) -> tuple[Floats, Ints, Floats] | None:
    """Return the beams of the first object that has any.

    Returns
    -------
    beams
        Nodes ``(n, 3)`` mm, struts ``(m, 2)`` and radii ``(m, 2)`` mm at both ends; None if the file has no beams.

    Raises
    ------
    InputError
        If the file cannot be read or has too many beams.
    """
    from lib3mf import Lib3MF

    package = open_package(path)
    try:
        model = load_model(package.data).model
        scale = unit_of(model)[1]
        objects = model.GetMeshObjects()
        while objects.MoveNext():
            mesh = objects.GetCurrentMeshObject()
            lattice = mesh.BeamLattice()
            if lattice.GetBeamCount() > MOST_BEAMS:
                raise InputError(
                    f"{path}: expected at most {MOST_BEAMS} beams in a cell, found {lattice.GetBeamCount()}"
                )
            if lattice.GetBeamCount():
                struts, radii = fetch_beams(lattice)
                nodes = fetch_mesh(mesh).vertices if mesh.GetVertexCount() else np.empty((0, 3))
                used, local = np.unique(struts, return_inverse=True)
                return nodes[used] * scale, local.reshape(-1, 2).astype(np.int32), radii * scale
    except Lib3MF.ELib3MFException as error:
        raise InputError(f"{path}: lib3mf cannot read this file ({error})") from error
    return None
