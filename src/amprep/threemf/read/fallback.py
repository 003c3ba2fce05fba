"""Read a 3MF file that lib3mf refuses with trimesh, which keeps only shapes and names."""

import io
from pathlib import Path

import numpy as np

from amprep.errors import InputError
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.threemf.package.open import Package


def read_by_trimesh(package: Package, path: Path, refusal: str) -> list[Part]:
    """Return one part for each instance in the build.

    Parameters
    ----------
    package
        The scanned package of the file `path`.
    refusal
        Reason why lib3mf refused the file; it becomes a note of the first part.

    Raises
    ------
    InputError
        If trimesh cannot read the file either, or finds no mesh in it.
    """
    import trimesh

    try:
        scene = trimesh.load_scene(io.BytesIO(package.data), file_type="3mf", process=False)
        scale = trimesh.units.unit_conversion(scene.units or "millimeters", "millimeters")
        meshes = [mesh for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    except Exception as error:  # trimesh passes on any exception of the libraries it uses
        message = " ".join(str(error).split())[:200]
        raise InputError(
            f"{path}: lib3mf refuses this file ({refusal}), and trimesh too ({message})"
        ) from error
    if not meshes:
        raise InputError(f"{path}: lib3mf refuses this file ({refusal}), and trimesh finds no mesh in it")
    note = f"lib3mf refuses this file ({refusal}); read by trimesh: shapes and names only"
    return [
        Part(
            name=str(mesh.metadata.get("name") or path.stem),
            mesh=Mesh(np.asarray(mesh.vertices) * scale, mesh.faces),
            volume_mm3=0.0,
            source=str(path),
            notes=() if index else (*package.notes, note),
        )
        for index, mesh in enumerate(meshes)
    ]
