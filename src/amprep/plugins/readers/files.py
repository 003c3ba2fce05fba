"""Read mesh files into parts: STL with our own reader, other formats with trimesh after checks of their size."""

import io
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.errors import InputError
from amprep.geometry.meshes.topology import merge_equal_vertices
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.plugins.readers.limits import check_gltf, check_off, check_ply, read_bounded
from amprep.plugins.readers.stl import read_stl

_METRE = 1000.0
_SPLIT: dict[str, Any] = {"split_objects": True, "group_material": False, "maintain_order": True}


class _Named(NamedTuple):
    name: str
    vertices: Floats
    triangles: Int64s


def read_mesh_file(path: Path, scale: float = 1.0) -> list[Part]:
    """Return the parts of a mesh file: one part, or one per mesh of a scene with its transform applied.

    Vertices at equal positions are merged, because most of these formats repeat them.

    Parameters
    ----------
    scale
        Length in mm of the unit of formats that do not state theirs, which are all but glTF.

    Raises
    ------
    InputError
        If the file does not match its suffix, is damaged or too large, or refers to other files.
    """
    content = read_bounded(path)
    suffix = path.suffix.lower()
    if suffix == ".stl":
        corners, notes = read_stl(content, path)
        vertices, triangles = corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)
        return _parts(_scaled([_Named(path.stem, vertices, triangles)], scale), notes, path)
    if suffix in (".glb", ".gltf"):
        return read_gltf(content, suffix, path, ("scaled from metres, the unit of glTF, to millimetres",))
    checks: dict[str, Callable[[bytes, Path], None]] = {".ply": check_ply, ".off": check_off}
    if suffix in checks:
        checks[suffix](content, path)
    meshes = _load(content, suffix[1:], path, **(_SPLIT if suffix == ".obj" else {}))
    in_order = meshes[::-1] if suffix == ".obj" else meshes  # trimesh returns objects in reverse order
    return _parts(_scaled(in_order, scale), (), path)


def read_gltf(content: bytes, suffix: str, path: Path, notes: tuple[str, ...]) -> list[Part]:
    """Return a part for each mesh of a glTF scene, scaled from metres to millimetres.

    Parameters
    ----------
    content
        The bytes of the file.
    suffix
        ``.glb`` or ``.gltf``.
    path
        The file's name in messages and in the parts.
    notes
        Notes for the first part.
    """
    check_gltf(content, path, binary=suffix == ".glb")
    meshes = _load(content, suffix[1:], path, merge_primitives=True)
    return _parts(_scaled(meshes, _METRE), notes, path)


def _scaled(meshes: list[_Named], scale: float) -> list[_Named]:
    return meshes if scale == 1.0 else [mesh._replace(vertices=mesh.vertices * scale) for mesh in meshes]


def _load(content: bytes, kind: str, path: Path, **options: Any) -> list[_Named]:
    """Read the meshes of a file with trimesh. It gets bytes only, so it cannot open other files."""
    import trimesh

    try:
        with warnings.catch_warnings():
            # numpy only warns about text that it cannot parse, and returns the numbers before it
            warnings.filterwarnings("error", message="string or file could not be read")
            scene = trimesh.load_scene(
                io.BytesIO(content), file_type=kind, process=False, skip_materials=True, **options
            )
        return list(_instances(scene))
    except Exception as error:  # trimesh passes on the exceptions of its parsers
        words = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        raise InputError(
            f"{path}: cannot be read as {kind.upper()} ({words}); the file may be damaged"
        ) from error


def _instances(scene: Any) -> Iterator[_Named]:
    """Yield the meshes of a scene with their transforms applied; mirrored ones keep outward normals."""
    for node in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if len(getattr(mesh, "faces", ())):
            vertices, triangles = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)
            if not np.array_equal(matrix, np.eye(4)):
                vertices = vertices @ matrix[:3, :3].T + matrix[:3, 3]
            mirrored = np.linalg.det(matrix[:3, :3]) < 0.0
            yield _Named(str(node), vertices, triangles[:, ::-1] if mirrored else triangles)


def _parts(meshes: list[_Named], notes: tuple[str, ...], path: Path) -> list[Part]:
    if not any(len(mesh.triangles) for mesh in meshes):
        raise InputError(f"{path}: the file contains no triangles")
    return [
        Part(
            name=_printable(mesh.name) if len(meshes) > 1 else path.stem,
            mesh=_merged(mesh, path),
            volume_mm3=0.0,
            source=str(path),
            notes=notes if index == 0 else (),
        )
        for index, mesh in enumerate(meshes)
    ]


def _merged(mesh: _Named, path: Path) -> Mesh:
    if not np.isfinite(mesh.vertices).all():
        raise InputError(f"{path}: the file contains non-finite coordinates; export it again")
    if mesh.triangles.min() < 0 or mesh.triangles.max() >= len(mesh.vertices):
        raise InputError(f"{path}: a triangle refers to a vertex that does not exist; the file is damaged")
    vertices, triangles = merge_equal_vertices(mesh.vertices, mesh.triangles)
    return Mesh(vertices, triangles.astype(np.int32))


def _printable(name: str) -> str:
    return "".join(char if char.isprintable() else " " for char in name).strip()[:200] or "mesh"
