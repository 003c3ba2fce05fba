"""Read cells from files: a graph in TOML or as beams in 3MF, or a closed mesh with an optional TOML file."""

import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from amprep.cells.offers import cell_offer
from amprep.cells.tables import graph_of, number, read_cell_table, text, variants_of, when_of
from amprep.checks.cells.templates import check_template
from amprep.errors import InputError, MeshError
from amprep.geometry.cells.ports import snapped
from amprep.hookspecs import CellEmitter
from amprep.model import DeclaredCell, GraphCell, Mesh, MeshCell, Shape, Template, Variant

MESH_SUFFIXES = (".stl", ".obj", ".3mf", ".ply", ".off", ".glb", ".step", ".stp")

_SUMMARY = "A cell from a file."

ReadMesh = Callable[[Path], Mesh]
"""Reads the only mesh of a file."""


class CellFile(NamedTuple):
    """A cell from a file, with its name and a sentence for lists."""

    name: str
    summary: str
    cell: DeclaredCell


def read_cell(path: Path, read_mesh: ReadMesh) -> CellFile:
    """Return the cell that a file declares.

    Parameters
    ----------
    path
        TOML file or mesh file. If a TOML file of the same name is beside a mesh file, it is read as well.
    read_mesh
        Reads mesh files.

    Raises
    ------
    InputError
        If a file does not declare a cell; the message names the file and the reason.
    """
    beside = path if path.suffix.lower() == ".toml" else path.with_suffix(".toml")
    table = read_cell_table(beside) if beside.is_file() else {}
    if path != beside:
        table = {**table, "mesh": path.name}
    cell = DeclaredCell(
        _variants(table, beside, read_mesh),
        text(table, "author", str(beside)),
        text(table, "licence", str(beside)),
        number(table, "smallest_feature_mm", str(beside)),
        number(table, "least_angle_deg", str(beside)),
    )
    name = text(table, "name", str(beside)) or path.stem
    return CellFile(name, text(table, "summary", str(beside)) or _SUMMARY, cell)


def _variants(table: Mapping[str, Any], beside: Path, read_mesh: ReadMesh) -> tuple[Variant, ...]:
    """Return the variants that a table declares; the shape at its top, if there is one, is the last variant."""
    size = number(table, "size_mm", str(beside), 1.0) or 0.0
    if not 0.0 < size < 1e6:
        raise InputError(
            f"{beside}: size_mm, the edge of the cube in which the mesh is drawn, must be above 0, got {size:g}"
        )
    variants = [
        Variant(_shape(each, beside, size, read_mesh), when_of(each, beside))
        for each in variants_of(table, beside)
    ]
    if any(key in table for key in ("mesh", "points")) or not variants:
        variants.append(Variant(_shape(table, beside, size, read_mesh)))
    return tuple(variants)


def cells_in(folder: Path | str, read_mesh: ReadMesh | None = None) -> Iterator[CellEmitter]:
    """Yield the offers of all cells in a folder, in the order of their names.

    Each TOML file but ``pyproject.toml`` is a cell, and so is each STL, OBJ or 3MF file that no TOML file names.

    Parameters
    ----------
    folder
        The folder, or a file in it: a plugin passes its ``__file__``.
    read_mesh
        Reads mesh files; the default is trimesh.

    Raises
    ------
    InputError
        If a TOML file does not declare a cell, or the folder holds no cell. A mesh file is read only when its cell is
        used, and refused then.
    """
    place = Path(folder)
    place = place.parent if place.is_file() else place
    files = sorted(path for path in place.glob("*.toml") if path.name != "pyproject.toml")
    tables = [read_cell_table(path) for path in files]
    shapes = [
        shape
        for table, path in zip(tables, files, strict=True)
        for shape in (table, *variants_of(table, path))
    ]
    named = {str(shape.get("mesh", "")) for shape in shapes}
    count = 0
    for path in sorted(place.iterdir()):
        alone = path.suffix.lower() in (".stl", ".obj", ".3mf") and path.name not in named
        if path in files or (alone and path.with_suffix(".toml") not in files):
            count += 1
            yield _offer_of(path, read_mesh or _plain_mesh)
    if not count:
        raise InputError(
            f"{place}: no cell in this folder; a package must install its TOML and mesh files with it"
        )


def _offer_of(path: Path, read_mesh: ReadMesh) -> CellEmitter:
    """Return the offer of a file. Meshes are read only when the cell is used, so that a plugin loads quickly."""
    table = read_cell_table(path) if path.suffix.lower() == ".toml" else {}
    name = _slug(text(table, "name", str(path)) or path.stem)
    summary = text(table, "summary", str(path)) or _SUMMARY
    if table and not any("mesh" in shape for shape in (table, *variants_of(table, path))):
        return cell_offer(name, summary, read_cell(path, read_mesh).cell)
    read = cache(lambda: read_cell(path, read_mesh).cell)
    return cell_offer(name, summary, lambda _pitch, _step, _params: read())


def _shape(table: Mapping[str, Any], path: Path, size: float, read_mesh: ReadMesh) -> Shape:
    """Return the shape that a table declares: the mesh that it names, or its graph."""
    if "mesh" not in table:
        return graph_of(table, path)
    file = path.parent / text(table, "mesh", str(path))
    if file.suffix.lower() not in MESH_SUFFIXES or not file.is_file():
        raise InputError(f"{path}: mesh must name a mesh file in the same folder, found none at {file}")
    if file.suffix.lower() == ".3mf":
        graph = _beams(file, size)
        if graph is not None:
            return graph
    return MeshCell(closed_cell(read_mesh(file), file, size))


def closed_cell(mesh: Mesh, path: Path, size: float = 1.0) -> Mesh:
    """Return the mesh of a cell in the unit cube; corners close to a side are moved onto it.

    Parameters
    ----------
    mesh
        Mesh of the cell, drawn in a cube of `size` mm.
    path
        File of the mesh, for messages.
    size
        Edge of the cube, mm.

    Raises
    ------
    MeshError
        If the mesh is not a closed solid inside the cube.
    """
    shrunk = Mesh(snapped(mesh.vertices / size), mesh.triangles)
    for violation in check_template(Template(path.stem, shrunk)):
        raise MeshError(f"{path}: a cell must be a closed mesh in the unit cube, z up; {violation.message}")
    return shrunk


def _beams(path: Path, size: float) -> GraphCell | None:
    """Return the beam lattice of a 3MF file as a graph, or None if the file has none."""
    from amprep.threemf import read_beams

    lattice = read_beams(path)
    if lattice is None:
        return None
    nodes, struts, radii = lattice
    try:
        return GraphCell(np.clip(snapped(nodes / size), *_clip_bounds(nodes / size)), struts, radii)
    except ValueError as error:
        raise InputError(f"{path}: {str(error)[:200]}; give size_mm in a TOML file beside it") from error


def _clip_bounds(points: np.ndarray) -> tuple[float, float]:
    """Return bounds that clip points to the cube if only rounding took them out of it, else infinite bounds."""
    close = bool((points > -1e-5).all() and (points < 1.0 + 1e-5).all())
    return (0.0, 1.0) if close else (-np.inf, np.inf)


def _plain_mesh(path: Path) -> Mesh:
    """Read a mesh file of an installed package."""
    import trimesh

    from amprep.geometry.meshes.topology import merge_equal_vertices

    loaded = trimesh.load_mesh(path, process=False)
    points, triangles = merge_equal_vertices(
        np.asarray(loaded.vertices, np.float64), np.asarray(loaded.faces, np.int64)
    )
    return Mesh(points, triangles.astype(np.int32))


def _slug(name: str) -> str:
    return re.sub(r"[^a-z0-9_.-]+", "-", name.lower()).strip("-") or "cell"
