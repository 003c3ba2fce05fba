"""Read a build file that another program may have changed: what amprep recorded, and the bodies that are in it now."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.checks.printed.found import PrintedBody
from amprep.errors import InputError
from amprep.model.build import Build, Target
from amprep.model.mesh import Mesh
from amprep.threemf.as_read import read_as_printed
from amprep.threemf.as_read.bambu import read_as_bambu
from amprep.threemf.as_read.structure import read_structure
from amprep.threemf.build import record
from amprep.threemf.build.identifier import identifiers_in
from amprep.threemf.build.metadata import BuildMetadata, read_metadata
from amprep.threemf.build.read import check_version, placed_parts, settings_in, support_of
from amprep.threemf.build.stored_bodies import BodyReader, StoredBody
from amprep.threemf.build.values import as_list, as_object, from_json, integer, integers, table
from amprep.threemf.names import CURA_NAMESPACE
from amprep.threemf.package.open import Package, open_package
from amprep.threemf.read.arrays import load_model

_MOST_NAMES = 10_000


class EditedFile(NamedTuple):
    """A build file that may have been edited.

    Attributes
    ----------
    recorded
        The build as amprep wrote it, without the parts and supports that are no longer in the file; None if the file
        has no record.
    deleted
        Number of parts that the record counts and the file does not contain.
    bodies
        The bodies as they are now, mm, in the coordinates of the file.
    target
        The program for which the file is, as its contents say.
    identifiers
        Identifiers of builds in the names of its objects.
    """

    recorded: Build | None
    deleted: int
    bodies: tuple[PrintedBody, ...]
    target: Target
    identifiers: tuple[str, ...]


def read_edited_file(path: Path) -> EditedFile:
    """Read a 3MF file with parts and supports of a build, whatever program saved it last.

    Raises
    ------
    InputError
        If the file is hostile or broken, or if its record is damaged or has another format version.
    """
    package = open_package(path)
    import lib3mf

    try:
        metadata = read_metadata(package.data)
        model = load_model(package.data).model
        recorded, deleted = None, 0
        if record.FORMAT in metadata.model:
            check_version(metadata.model[record.FORMAT], path)
            recorded, deleted = _recorded(model, metadata)
        target = _target(package) if recorded is None else recorded.settings.target
        unit_mm, bodies = _bodies(package, model, target)
    except lib3mf.ELib3MFException as error:
        raise InputError(f"{path}: lib3mf refuses the file ({error}); export it again") from error
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(f"{path}: cannot be read as an edited build ({error}); export it again") from error
    found = tuple(_in_millimetres(each, unit_mm) for each in bodies)
    return EditedFile(recorded, deleted, found, target, _identifiers(package, model))


def _bodies(package: Package, model: Any, target: Target) -> tuple[float, Sequence[PrintedBody]]:
    """Return the length of the unit, mm, and the bodies in the file."""
    if package.bambu_config:
        return read_structure(package.data).unit_mm, read_as_bambu(package, model)
    printed = read_as_printed(package.data, model, target)
    return printed.unit_mm, printed.bodies


def _target(package: Package) -> Target:
    """Return the program that saved a file without a record."""
    if package.prusaslicer_config:
        return "prusaslicer"
    return "cura" if CURA_NAMESPACE.encode() in package.data else "generic"


def _identifiers(package: Package, model: Any) -> tuple[str, ...]:
    """Return the identifiers of builds in names of objects, which slicers store in their configurations."""
    configurations = (package.prusaslicer_config, package.bambu_config)
    names, objects = [each.decode("utf-8", "replace") for each in configurations], model.GetObjects()
    while objects.MoveNext() and len(names) <= _MOST_NAMES:
        names.append(objects.GetCurrentObject().GetName())
    return tuple(identifiers_in("\n".join(names)))


def _in_millimetres(body: PrintedBody, unit_mm: float) -> PrintedBody:
    if unit_mm == 1.0:
        return body
    return replace(body, mesh=Mesh(body.mesh.vertices * unit_mm, body.mesh.triangles))


def _recorded(model: Any, metadata: BuildMetadata) -> tuple[Build, int]:
    """Return the build as it was written, of those parts and supports that are still in the file."""
    settings = settings_in(metadata)
    known = as_list(from_json(metadata.model.get(record.PARTS, "null")), record.PARTS)
    listed = as_list(from_json(metadata.model.get(record.UNSUPPORTED, "[]")), record.UNSUPPORTED)
    stored = _first_of_each(_stored_bodies(model, metadata))
    written = sorted(each.record["index"] for each in stored if each.role == "part")
    number = {old: new for new, old in enumerate(written)}
    parts = placed_parts([_numbered(each, number) for each in stored if each.role == "part"], known)
    most = max([*written, -1]) + 1
    contents = as_object(from_json(metadata.model.get(record.CONTENTS, "{}")), record.CONTENTS)
    total = max(integer(contents, "parts") if "parts" in contents else 0, most)
    supports = [each for each in stored if each.role == "support" and _is_whole(each, number, total)]
    regions = [record.unsupported_of(each, total) for each in listed]
    build = Build(
        settings,
        parts,
        tuple(support_of(_holding(each, number, total), len(parts)) for each in supports),
        tuple(replace(each, part=number[each.part]) for each in regions if each.part in number),
    )
    return build, total - len(parts)


def _stored_bodies(model: Any, metadata: BuildMetadata) -> list[StoredBody]:
    """Return the bodies of the items that have a record, each where it was written.

    The record of an item from which a part or support was removed describes it no longer.
    """
    found: list[StoredBody] = []
    for entries, read in zip(metadata.items, BodyReader(model).items(), strict=True):
        if record.BODIES in entries:
            records = as_list(from_json(entries[record.BODIES]), record.BODIES)
            try:
                bodies = list(read([as_object(each, "a body") for each in records]))
            except ValueError:
                continue
            found += _where_written(bodies)
    return found


def _where_written(bodies: Sequence[StoredBody]) -> list[StoredBody]:
    """Return the bodies of an item at the places that their records state, whatever moved the item since.

    Supports are written in coordinates of the build, or in those of the first part of their item.
    """
    frames = [_recorded_place(each) for each in bodies if each.role == "part"]
    if not frames:
        raise ValueError("an item has supports without a part")
    frame = frames[0].astype(np.float32).astype(np.float64)
    return [
        replace(
            each,
            matrix=_recorded_place(each)
            if each.role == "part"
            else frame
            if "vertices" in each.record
            else np.eye(4),
        )
        for each in bodies
    ]


def _recorded_place(body: StoredBody) -> Floats:
    matrix = np.eye(4)
    matrix[:3] = table(body.record, "at", 12).reshape(3, 4)
    return matrix


def _first_of_each(bodies: Sequence[StoredBody]) -> list[StoredBody]:
    """Return each recorded part and support once; copies of an item have the same record."""
    found: dict[tuple[str, int], StoredBody] = {}
    for each in bodies:
        found.setdefault((each.role, integer(each.record, "index")), each)
    return list(found.values())


def _numbered(body: StoredBody, number: dict[int, int]) -> StoredBody:
    return replace(body, record={**body.record, "index": number[body.record["index"]]})


def _is_whole(support: StoredBody, number: dict[int, int], total: int) -> bool:
    """Return whether all parts that a support holds are in the file."""
    return all(each in number for each in integers(support.record, "holds", below=total))


def _holding(support: StoredBody, number: dict[int, int], total: int) -> StoredBody:
    held = [number[each] for each in integers(support.record, "holds", below=total)]
    return replace(support, record={**support.record, "holds": held})
