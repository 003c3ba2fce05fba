"""Find the regions of parts to fill: modifiers in the input file, and meshes of other files."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from amprep.errors import InputError, JobError, MeshError, nearest_hint
from amprep.geometry.meshes.repair import repair_mesh
from amprep.model import Mesh, Part, Region
from amprep.model.part import RegionKind
from amprep.threemf import modifier_note

Read = Callable[[Path], list[Part]]

KIND: RegionKind = "lattice"


def with_files(parts: Sequence[Part], files: Sequence[Path], read: Read) -> list[Part]:
    """Return the parts with the meshes of files as further regions, where their bounding boxes meet.

    Parameters
    ----------
    parts
        The parts of the job.
    files
        Mesh files in the coordinates of the input.
    read
        Function that reads the parts of a file.

    Raises
    ------
    InputError
        When a file does not exist or cannot be read.
    JobError
        When the mesh of a file meets no part.
    """
    result = list(parts)
    for file in files:
        if not file.is_file():
            raise InputError(f"{file}: no such file; a region is a mesh file in the coordinates of the input")
        found = [
            (piece.name, Mesh(piece.mesh.vertices + at, piece.mesh.triangles))
            for piece in read(file)
            for at in piece.origins
        ]
        near = [[region for name, mesh in found for region in _met(name, mesh, part)] for part in parts]
        if not any(near):
            raise JobError(
                f"{file}: the region is outside all parts; its coordinates must be those of the input"
            )
        result = [
            replace(part, regions=(*part.regions, *own)) for part, own in zip(result, near, strict=True)
        ]
    return result


def chosen(parts: Sequence[Part], names: Sequence[str]) -> list[tuple[Region, ...]]:
    """Return for each part its regions of the given names as closed meshes, all regions if no names are given.

    Raises
    ------
    JobError
        When no part has a region, or none has a region of one of the names.
    MeshError
        When a region is not a closed mesh.
    """
    found = [
        [region for region in part.regions if region.kind == KIND and region.mesh is not None]
        for part in parts
    ]
    known = {region.name for own in found for region in own}
    if not known:
        raise JobError(
            "no region to fill: mark one as a modifier in the slicer, or give a mesh with --region, or --shell"
        )
    for name in names:
        if name not in known:
            raise JobError(f"no region is called {name!r}{nearest_hint(name, known)}")
    return [
        tuple(_closed(region, part) for region in own if not names or region.name in names)
        for part, own in zip(parts, found, strict=True)
    ]


def without(part: Part, filled: Sequence[Region]) -> Part:
    """Return the part without the regions that were filled, and without the notes about them."""
    names = {region.name for region in filled}
    notes = {modifier_note(name) for name in names}
    kept = [region for region in part.regions if region.kind != KIND or region.name not in names]
    return replace(part, regions=tuple(kept), notes=tuple(note for note in part.notes if note not in notes))


def _met(name: str, mesh: Mesh, part: Part) -> list[Region]:
    """Return the mesh as a region in the coordinates of the part, at the first position where their boxes meet."""
    (low, high), (part_low, part_high) = mesh.bounds, part.mesh.bounds
    for at in part.origins:
        if (low < part_high + at).all() and (high > part_low + at).all():
            return [Region(KIND, name, mesh=Mesh(mesh.vertices - at, mesh.triangles))]
    return []


def _closed(region: Region, part: Part) -> Region:
    if region.mesh is None:
        return region
    repaired = repair_mesh(region.mesh.vertices, region.mesh.triangles)
    if repaired.problem:
        raise MeshError(f"{part.name}: the region {region.name!r} is not a closed mesh: {repaired.problem}")
    return replace(region, mesh=Mesh(repaired.vertices, repaired.triangles))
