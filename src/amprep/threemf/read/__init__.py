"""Read the parts of a 3MF job: what each build item shows, in millimetres, with all that is said of it."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.errors import InputError
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance, Part, Region
from amprep.threemf.package.open import Package, open_package
from amprep.threemf.read.arrays import Model3MF, load_model
from amprep.threemf.read.colours import appearance_of
from amprep.threemf.read.job_metadata import foreign, wishes_of
from amprep.threemf.read.objects import Gatherer, Shape, row_matrix
from amprep.threemf.read.slicer_config import (
    Loose,
    cura_role,
    parse_part_roles,
    parse_slicer_config,
    with_loose,
)

if TYPE_CHECKING:
    from lib3mf import Lib3MF

_UNITS = (
    ("micrometres", 0.001),
    ("millimetres", 1.0),
    ("centimetres", 10.0),
    ("inches", 25.4),
    ("feet", 304.8),
    ("metres", 1000.0),
)
"""In the order of lib3mf's `ModelUnit`: name, and mm of one."""


class _Item(NamedTuple):
    """Build items that ask for the same: an object under a linear map, and what is said of it."""

    thing: "Lib3MF.Object"
    linear: Floats
    translation: Floats
    part_number: str
    metadata: dict[tuple[str, str], str]


def read_parts(path: Path) -> list[Part]:
    """Return the parts a 3MF file's build asks for, not yet settled.

    An item's linear map is applied to the mesh, its translation kept as a position; items of one object under
    the same map are one part. Components become one mesh. A file that lib3mf refuses is read by trimesh.

    Raises
    ------
    InputError
        If the file cannot be read, is hostile, or its build asks for nothing that can be printed.
    """
    from lib3mf import Lib3MF

    package = open_package(path)
    loaded = _load(package.data)
    if isinstance(loaded, str):
        from amprep.threemf.read.fallback import read_by_trimesh

        return read_by_trimesh(package, path, refusal=loaded)
    try:
        return _parts(loaded, package, path)
    except (Lib3MF.ELib3MFException, UnicodeDecodeError) as error:
        raise InputError(f"{path}: lib3mf cannot tell what is in this file ({error})") from error


def _load(data: bytes) -> Model3MF | str:
    """Return the model, or the reason why lib3mf refuses it."""
    from lib3mf import Lib3MF

    try:
        return load_model(data)
    except Lib3MF.ELib3MFException as error:
        return str(error).partition(": ")[2] or str(error)


def _parts(loaded: Model3MF, package: Package, path: Path) -> list[Part]:
    """Turn items into parts; notes on the file as a whole go to the first part."""
    unit, scale = _UNITS[int(loaded.model.GetUnit())]
    notes = [*package.notes, *_meant(loaded.warnings)]
    if scale != 1.0:
        notes.append(f"scaled from {unit} to millimetres")
    if package.unprintable:
        notes.append(f"left out {len(package.unprintable)} items that the file marks as not to be printed")
    volumes = parse_slicer_config(package.config, str(path))
    roles = parse_part_roles(package.part_config, str(path))
    gatherer = Gatherer(loaded.model, volumes, roles, package.paint, str(path))
    parts: list[Part] = []
    loose: list[Loose] = []
    for item, positions in _items(loaded.model, package.unprintable):
        shape = gatherer.shape_of(item.thing, item.linear, cura_role(item.metadata, item.thing.GetName()))
        if shape.regions and not sum(map(len, shape.triangles)):
            loose += [(_scaled(region, scale), positions * scale) for region in shape.regions]
            notes += shape.notes
        elif shape.vertices:
            notes = [*notes, *shape.notes]
            parts.append(_part(item, positions * scale, shape, scale, tuple(dict.fromkeys(notes)), path))
            notes = []
        else:
            notes += shape.notes
    if not parts:
        raise InputError(f"{path}: the build asks for nothing that can be printed{_because(notes)}")
    parts[-1] = replace(parts[-1], notes=tuple(dict.fromkeys([*parts[-1].notes, *notes])))
    return with_loose(parts, loose)


def _items(model: "Lib3MF.Model", unprintable: frozenset[int]) -> Iterator[tuple[_Item, Floats]]:
    """Yield the different build items, and the positions ``(k, 3)`` of each, in the order of their first."""
    found: dict[object, list[_Item]] = {}
    items = model.GetBuildItems()
    index = 0
    while items.MoveNext():
        if index not in unprintable:
            item = _item(items.GetCurrent())
            key = (item.thing.GetUniqueResourceID(), (item.linear + 0.0).tobytes(), item.part_number)
            found.setdefault((key, tuple(sorted(item.metadata.items()))), []).append(item)
        index += 1
    yield from ((same[0], np.array([item.translation for item in same])) for same in found.values())


def _item(item: "Lib3MF.BuildItem") -> _Item:
    thing = item.GetObjectResource()
    matrix = row_matrix(item.GetObjectTransform()) if item.HasObjectTransform() else np.eye(4)
    metadata = _metadata(thing.GetMetaDataGroup()) | _metadata(item.GetMetaDataGroup())
    return _Item(
        thing, matrix[:3, :3], matrix[3, :3], item.GetPartNumber() or thing.GetPartNumber(), metadata
    )


def _metadata(group: "Lib3MF.MetaDataGroup") -> dict[tuple[str, str], str]:
    entries = [group.GetMetaData(index) for index in range(group.GetMetaDataCount())]
    return {(entry.GetNameSpace(), entry.GetName()): entry.GetValue() for entry in entries}


def _part(
    item: _Item, positions: Floats, shape: Shape, scale: float, notes: tuple[str, ...], path: Path
) -> Part:
    name = part_name([item.thing.GetName(), *shape.names], path)
    wishes = wishes_of(item.metadata, f"{path}: {name}")
    vertices, triangles = shape.joined()
    return Part(
        name=name,
        mesh=Mesh(vertices * scale, triangles.astype(np.int32)),
        volume_mm3=0.0,
        quantity=wishes.quantity * len(positions),
        value=wishes.value,
        orientations=wishes.orientations,
        regions=tuple(_scaled(region, scale) for region in shape.regions),
        appearance=appearance_of(shape.paints) if len(triangles) else Appearance(),
        positions=positions,
        part_number=item.part_number,
        source=str(path),
        notes=notes,
        metadata=foreign(item.metadata),
    )


def part_name(candidates: list[str], path: Path) -> str:
    """Return the first name given, as one printable line and without a mesh file's suffix, or the file's."""
    for candidate in candidates:
        name = "".join(char if char.isprintable() else " " for char in candidate).strip()[:200]
        if name:
            suffix = PurePath(name).suffix.lower()
            return (
                name[: -len(suffix)] if suffix in (".stl", ".obj", ".3mf", ".amf", ".step", ".stp") else name
            )
    return path.stem


def _scaled(region: Region, scale: float) -> Region:
    if region.mesh is None or scale == 1.0:
        return region
    return replace(region, mesh=Mesh(region.mesh.vertices * scale, region.mesh.triangles))


def _meant(warnings: tuple[str, ...]) -> list[str]:
    """Return the warnings worth telling: not those of attributes others add, nor of missing UUIDs."""
    worth = [words for words in warnings if not re.search("namespace|uuid", words, re.IGNORECASE)]
    return [f"lib3mf warns: {words}" for words in worth[:10]]


def _because(notes: list[str]) -> str:
    return f" ({'; '.join(dict.fromkeys(notes))})" if notes else ""
