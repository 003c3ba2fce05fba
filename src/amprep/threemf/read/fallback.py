"""Read a 3MF that lib3mf refuses with trimesh, which keeps shapes and names only."""

import io
from pathlib import Path

import numpy as np

from amprep.errors import InputError
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.threemf.package.open import Package


def read_by_trimesh(package: Package, path: Path, refusal: str) -> list[Part]:
    """Return a part for each instance in the build; the first says why lib3mf refused the file.

    Raises
    ------
    InputError
        If trimesh cannot read it either, or finds nothing in it.
    """
    import trimesh

    try:
        scene = trimesh.load_scene(io.BytesIO(package.data), file_type="3mf", process=False)
        scale = trimesh.units.unit_conversion(scene.units or "millimeters", "millimeters")
        meshes = [mesh for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    except Exception as error:  # trimesh raises whatever its parts raise
        words = " ".join(str(error).split())[:200]
        raise InputError(
            f"{path}: lib3mf refuses this file ({refusal}), and trimesh too ({words})"
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
