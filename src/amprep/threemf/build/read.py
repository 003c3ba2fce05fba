"""Read a build back from its file: geometry and placements from the objects, the settings from amprep's metadata."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.checks.printed.found import PrintedBody, PrintedFile
from amprep.errors import InputError
from amprep.model.build import Build, BuildSettings, PlacedPart, StoredRecord, StoredSupport, SupportBody
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.threemf.as_read import read_as_printed
from amprep.threemf.build import record
from amprep.threemf.build.metadata import BuildMetadata, read_metadata, record_digest
from amprep.threemf.build.stored_bodies import BodyReader, StoredBody
from amprep.threemf.build.values import (
    as_list,
    as_object,
    boolean,
    from_json,
    integer,
    integers,
    string,
    table,
)
from amprep.threemf.package.open import open_package
from amprep.threemf.read.arrays import load_model
from amprep.threemf.transforms import from_corner


class BuildFile(NamedTuple):
    """A build as amprep's metadata describes it, and what the target of the file would print."""

    build: Build
    printed: PrintedFile


def read_build(path: Path) -> Build:
    """Read a build that amprep wrote, in any dialect, from the file alone; see `read_build_file`."""
    return read_build_file(path).build


def read_build_file(path: Path) -> BuildFile:
    """Read a build that amprep wrote, in any dialect, and read the file again as its target does.

    The metadata is used only for facts that the objects in the file do not show. `PlacedPart.recorded_digest` is the
    digest that the metadata states; `amprep.checks` compares it with that of the geometry.

    Raises
    ------
    InputError
        If the file is hostile or broken, was not written by amprep, has another format version, or if its
        metadata is damaged or does not agree with its objects.
    """
    package = open_package(path)
    import lib3mf

    try:
        metadata = read_metadata(package.data)
        check_version(metadata.model.get(record.FORMAT), path)
        model = load_model(package.data).model
        build = _build(model, metadata)
        return BuildFile(build, _as_printed(package.data, model, build, path))
    except lib3mf.ELib3MFException as error:
        raise InputError(f"{path}: lib3mf refuses the file ({error}); write the build again") from error
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(
            f"{path}: amprep's metadata in the file is damaged ({error}); write the build again"
        ) from error


def _as_printed(package: bytes, model: Any, build: Build, path: Path) -> PrintedFile:
    target = build.settings.target
    try:
        printed = read_as_printed(package, model, target)
    except ValueError as error:
        raise InputError(
            f"{path}: the target {target} cannot read it ({error}); write the build again"
        ) from error
    x, y = build.settings.plate_origin
    return replace(printed, bodies=tuple(_moved_by(each, -x, -y) for each in printed.bodies))


def _moved_by(body: PrintedBody, x: float, y: float) -> PrintedBody:
    """Return a body moved along the plate; only slicers have an origin elsewhere, and their files have no beams."""
    if x == y == 0.0:
        return body
    return replace(body, mesh=Mesh(body.mesh.vertices + (x, y, 0.0), body.mesh.triangles))


def check_version(version: str | None, path: Path) -> None:
    """Raise InputError unless the format version of a record is the one that this version of amprep reads."""
    if version is None:
        raise InputError(
            f"{path}: expected a build that amprep wrote, found a 3MF file without amprep's metadata; "
            "give a file that amprep run made"
        )
    if version != record.FORMAT_VERSION:
        raise InputError(
            f"{path}: expected a build in format version {record.FORMAT_VERSION}, found {version[:20]!r}; "
            "use the version of amprep that wrote it"
        )


def _build(model: Any, metadata: BuildMetadata) -> Build:
    settings = settings_in(metadata)
    known = as_list(_value(metadata.model, record.PARTS), record.PARTS)
    stored = BodyReader(model).read([_value(item, record.BODIES) for item in metadata.items])
    bodies = [replace(each, matrix=from_corner(each.matrix, settings.plate_origin)) for each in stored]
    parts = placed_parts([body for body in bodies if body.role == "part"], known)
    supports = tuple(
        support_of(body, len(parts))
        for body in _in_order([body for body in bodies if body.role == "support"])
    )
    if record.CONTENTS in metadata.model:
        record.check_contents(_value(metadata.model, record.CONTENTS), len(parts), len(supports))
    regions = as_list(_value(metadata.model, record.UNSUPPORTED), record.UNSUPPORTED)
    unsupported = tuple(record.unsupported_of(each, len(parts)) for each in regions)
    recorded = metadata.model.get(record.DIGEST, "")
    own = StoredRecord(recorded, record_digest(metadata.model, metadata.items))
    return Build(settings, parts, supports, unsupported, own)


def settings_in(metadata: BuildMetadata) -> BuildSettings:
    """Return the settings of a build from its metadata; raise ValueError for damaged ones."""
    space = record.volume_of(_value(metadata.model, record.VOLUME))
    settings = record.settings_of(_value(metadata.model, record.SETTINGS), space)
    if record.PLANNING not in metadata.model:
        return settings
    planning = as_object(_value(metadata.model, record.PLANNING), record.PLANNING)
    return replace(settings, planning=planning)


def _value(entries: dict[str, str], name: str) -> Any:
    """Return the value of the metadata entry `name`, which must be present."""
    if name not in entries:
        raise ValueError(f"{name} is missing")
    return from_json(entries[name])


def placed_parts(bodies: Sequence[StoredBody], known: Sequence[Any]) -> tuple[PlacedPart, ...]:
    """Return the parts in their order in the build; copies with the same geometry share one `Part`."""
    shared: dict[tuple[int, str], Part] = {}
    placed = []
    for body in _in_order(bodies):
        number = integer(body.record, "part", below=len(known))
        key = (number, body.mesh.digest)
        if key not in shared:
            shared[key] = record.part_of(known[number], body.mesh, body.colours)
        placed.append(_placed_part(body, shared[key]))
    if len({each.label for each in placed}) < len(placed):
        raise ValueError("two parts have the same label")
    return tuple(placed)


def _placed_part(body: StoredBody, part: Part) -> PlacedPart:
    own = body.record.get("orientations")
    return PlacedPart(
        string(body.record, "label"),
        part,
        body.matrix,
        part.orientations if own is None else record.orientations_of(own),
        string(body.record, "sha256"),
        _moved(body, table(body.record, "at", 12)) if "at" in body.record else 0.0,
    )


def _moved(body: StoredBody, placement: Floats) -> float:
    """Return how far (mm) a body is from where a placement of twelve numbers puts it, rounded to 1e-4."""
    if not len(body.mesh.vertices):
        return 0.0
    corners = np.vstack(body.mesh.bounds)
    corners = np.array(
        [[corners[i, 0], corners[j, 1], corners[k, 2], 1.0] for i, j, k in np.ndindex(2, 2, 2)]
    )
    off = (body.matrix[:3] - placement.reshape(3, 4)) @ corners.T
    return round(float(np.linalg.norm(off, axis=0).max()), 4)


def support_of(body: StoredBody, parts: int) -> SupportBody:
    """Return a support; the mesh of one with beams is the mesh for readers that do not know beams."""
    lattice, matrix = body.lattice, body.matrix
    if lattice is not None:
        nodes, solids, stand_in = (
            Mesh(lattice.nodes, np.empty((0, 3), np.int32)).moved(matrix).vertices,
            lattice.solids.moved(matrix),
            lattice.stand_in.moved(matrix),
        )
        lattice = replace(lattice, nodes=nodes, solids=solids, stand_in=stand_in)
    mesh = body.mesh.moved(matrix) if lattice is None else lattice.stand_in
    holds = integers(body.record, "holds", below=parts)
    own = body.record
    stored = StoredSupport(
        string(own, "sha256") if "sha256" in own else "",
        body.mesh.digest if body.lattice is None else body.lattice.digest,
        0.0 if "vertices" in own else _moved(body, np.eye(4)[:3]),
    )
    return SupportBody(
        string(own, "name"),
        mesh,
        holds,
        boolean(own, "surface") if "surface" in own else body.surface,
        lattice,
        reach=record.own_reach(own),
        sizes=record.sizes_of(own["sizes"]) if "sizes" in own else None,
        stored=stored,
    )


def _in_order(bodies: Sequence[StoredBody]) -> list[StoredBody]:
    """Return the bodies in the order of their recorded indices, which must be 0, 1, 2 and so on."""
    ordered = sorted(bodies, key=lambda body: integer(body.record, "index"))
    if [body.record["index"] for body in ordered] != list(range(len(ordered))):
        raise ValueError("the indices of the recorded bodies are not consecutive")
    return ordered
