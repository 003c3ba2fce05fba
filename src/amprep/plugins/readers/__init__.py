"""The built-in mesh readers: 3MF jobs, plain mesh files, STEP."""

from collections.abc import Iterable
from pathlib import Path

from amprep.hookspecs import MeshReader, hookimpl
from amprep.model.part import Part
from amprep.plugins.readers.params import MeshParams, ThreemfParams
from amprep.plugins.readers.step import StepParams

amprep_api = 1


@hookimpl
def amprep_mesh_readers() -> Iterable[MeshReader]:
    """Yield the built-in readers."""
    yield MeshReader(
        "3mf",
        "3MF jobs: build items with quantity, colours, materials and metadata.",
        run=_read_3mf,
        suffixes=(".3mf",),
        params=ThreemfParams,
    )
    yield MeshReader(
        "mesh",
        "Mesh files: STL, OBJ, PLY, OFF in millimetres or `unit`, GLB and glTF in metres.",
        run=_read_mesh,
        suffixes=(".stl", ".obj", ".ply", ".off", ".glb", ".gltf"),
        params=MeshParams,
    )
    yield MeshReader(
        "step",
        "STEP files, triangulated by OpenCASCADE; needs the extra amprep[step].",
        run=_read_step,
        suffixes=(".step", ".stp"),
        params=StepParams,
    )


def _read_3mf(path: Path, *, params: ThreemfParams) -> list[Part]:
    from amprep.threemf import read_parts

    return read_parts(path, strict=params.strict)


def _read_mesh(path: Path, *, params: MeshParams) -> list[Part]:
    from amprep.plugins.readers.files import read_mesh_file

    return read_mesh_file(path, params.scale)


def _read_step(path: Path, *, params: StepParams) -> list[Part]:
    from amprep.plugins.readers.step import read_step_file

    return read_step_file(path, params)
