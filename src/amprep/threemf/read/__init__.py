"""Read the parts of a 3MF job: one part per build item, in millimetres, with its metadata."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.model.counting import counted
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance, Part, Region
from amprep.threemf.package.open import Package, package_of, read_contents
from amprep.threemf.read.arrays import LoadedModel, unit_of
from amprep.threemf.read.colours import appearance_of
from amprep.threemf.read.job_metadata import foreign_metadata, parse_job_metadata
from amprep.threemf.read.objects import FlattenedItem, Flattener
from amprep.threemf.read.separate_regions import SeparateRegion, assign_regions
from amprep.threemf.read.slicer_config import cura_role, parse_bambu_config, parse_prusaslicer_config
from amprep.threemf.read.tolerance import load_tolerantly, refuse_broken, warnings_of
from amprep.threemf.rules import find_broken_rules
from amprep.threemf.transforms import row_matrix

if TYPE_CHECKING:
    from lib3mf import Lib3MF

_MESH_SUFFIXES = (".stl", ".obj", ".3mf", ".amf", ".step", ".stp")
_LONGEST_NAME = 200
_MOST_WARNINGS = 10


class _ItemRequest(NamedTuple):
    """The contents of a build item: object, linear map and translation for row vectors, part number and metadata."""

    thing: "Lib3MF.Object"
    linear: Floats
    translation: Floats
    part_number: str
    metadata: dict[tuple[str, str], str]


def read_parts(path: Path, *, strict: bool = False) -> list[Part]:
    """Return the parts in the build of a 3MF file; their meshes are not yet validated and repaired.

    The linear map of a build item is applied to the mesh, and its translation becomes a position of the part.
    Items of the same object with the same map become one part. Components are joined into one mesh. The first part
    has a warning for each rule of the specification that the file breaks.

    Parameters
    ----------
    strict
        Whether a file that breaks any rule is refused, instead of one that breaks a rule on which geometry, units or
        placement depend.

    Raises
    ------
    InputError
        If the file cannot be read, is hostile, breaks such a rule, or its build contains nothing that can be printed.
    """
    from lib3mf import Lib3MF

    contents = read_contents(path)
    broken = find_broken_rules(contents.entries)
    refuse_broken(broken, path, strict=strict)
    package = package_of(contents, path)
    loaded, complaint = load_tolerantly(package.data, path)
    try:
        parts = _parts(loaded, package, path)
    except (Lib3MF.ELib3MFException, UnicodeDecodeError) as error:
        raise InputError(f"{path}: lib3mf cannot read the contents of this file ({error})") from error
    return [replace(parts[0], warnings=warnings_of(broken, complaint)), *parts[1:]]


def _parts(loaded: LoadedModel, package: Package, path: Path) -> list[Part]:
    """Return one part for each different build item; the first part carries the notes about the file."""
    unit, scale = unit_of(loaded.model)
    notes = _relevant(loaded.warnings)
    if scale != 1.0:
        notes.append(f"scaled from {unit} to millimetres")
    if package.unprintable:
        notes.append(f"left out {counted(len(package.unprintable), 'item')}: the file says not to print")
    prusaslicer = parse_prusaslicer_config(package.prusaslicer_config, str(path))
    roles = parse_bambu_config(package.bambu_config, str(path))
    flattener = Flattener(loaded.model, prusaslicer, roles, package.painted, str(path))
    parts: list[Part] = []
    separate: list[SeparateRegion] = []
    for request, positions in _requests(loaded.model, package.unprintable):
        role = cura_role(request.metadata, request.thing.GetName())
        item = flattener.flatten(request.thing, request.linear, role)
        notes += item.notes
        if item.regions and not sum(map(len, item.triangles)):
            separate += [SeparateRegion(_scaled(each, scale), positions * scale) for each in item.regions]
        elif item.vertices:
            parts.append(_part(request, positions * scale, item, scale, tuple(dict.fromkeys(notes)), path))
            notes = []
    if not parts:
        raise InputError(f"{path}: the build contains nothing that can be printed{_because(notes)}")
    parts[-1] = replace(parts[-1], notes=tuple(dict.fromkeys([*parts[-1].notes, *notes])))
    return assign_regions(parts, separate)


def _requests(model: "Lib3MF.Model", unprintable: frozenset[int]) -> Iterator[tuple[_ItemRequest, Floats]]:
    """Yield each different request with its positions ``(k, 3)``, in the order of the first ones."""
    found: dict[object, list[_ItemRequest]] = {}
    items = model.GetBuildItems()
    index = 0
    while items.MoveNext():
        if index not in unprintable:
            request = _request(items.GetCurrent())
            key = (request.thing.GetUniqueResourceID(), (request.linear + 0.0).tobytes(), request.part_number)
            found.setdefault((key, tuple(sorted(request.metadata.items()))), []).append(request)
        index += 1
    yield from ((same[0], np.array([each.translation for each in same])) for same in found.values())


def _request(item: "Lib3MF.BuildItem") -> _ItemRequest:
    thing = item.GetObjectResource()
    matrix = row_matrix(item.GetObjectTransform()) if item.HasObjectTransform() else np.eye(4)
    metadata = _metadata(thing.GetMetaDataGroup()) | _metadata(item.GetMetaDataGroup())
    number = item.GetPartNumber() or thing.GetPartNumber()
    return _ItemRequest(thing, matrix[:3, :3], matrix[3, :3], number, metadata)


def _metadata(group: "Lib3MF.MetaDataGroup") -> dict[tuple[str, str], str]:
    entries = [group.GetMetaData(index) for index in range(group.GetMetaDataCount())]
    return {(entry.GetNameSpace(), entry.GetName()): entry.GetValue() for entry in entries}


def _part(
    request: _ItemRequest,
    positions: Floats,
    item: FlattenedItem,
    scale: float,
    notes: tuple[str, ...],
    path: Path,
) -> Part:
    name = part_name([request.thing.GetName(), *item.names], path)
    settings = parse_job_metadata(request.metadata, f"{path}: {name}")
    vertices, triangles = item.joined()
    return Part(
        name=name,
        mesh=Mesh(vertices * scale, triangles.astype(np.int32)),
        volume_mm3=0.0,
        quantity=settings.quantity * len(positions),
        value=settings.value,
        orientations=settings.orientations,
        regions=tuple(_scaled(region, scale) for region in item.regions),
        appearance=appearance_of(item.colours) if len(triangles) else Appearance(),
        positions=positions,
        part_number=request.part_number,
        source=str(path),
        notes=notes,
        metadata=foreign_metadata(request.metadata),
    )


def part_name(candidates: list[str], path: Path) -> str:
    """Return the first candidate that is not blank, as one printable line without a mesh file's suffix.

    Parameters
    ----------
    candidates
        Names in the file, most specific first.
    path
        The file; its stem is the name if there is no other.
    """
    for candidate in candidates:
        name = "".join(char if char.isprintable() else " " for char in candidate).strip()[:_LONGEST_NAME]
        if name:
            suffix = PurePath(name).suffix
            return name[: -len(suffix)] if suffix.lower() in _MESH_SUFFIXES else name
    return path.stem


def _scaled(region: Region, scale: float) -> Region:
    if region.mesh is None or scale == 1.0:
        return region
    return replace(region, mesh=Mesh(region.mesh.vertices * scale, region.mesh.triangles))


def _relevant(warnings: tuple[str, ...]) -> list[str]:
    """Return lib3mf's warnings, without those on foreign attributes, UUIDs, and what the rules have reported."""
    reported = "namespace|uuid|model metadata"
    relevant = [text for text in warnings if not re.search(reported, text, re.IGNORECASE)]
    return [f"lib3mf warns: {text}" for text in relevant[:_MOST_WARNINGS]]


def _because(notes: list[str]) -> str:
    return f" ({'; '.join(dict.fromkeys(notes))})" if notes else ""
