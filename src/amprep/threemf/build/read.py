"""Reading a build job back: geometry and placements from its objects, the rules from amprep's record."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from amprep.errors import InputError
from amprep.model.build import Build, PlacedPart, SupportBody
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.threemf.build import record
from amprep.threemf.build.metadata import Entries, read_entries
from amprep.threemf.build.pieces import Piece, PieceReader
from amprep.threemf.build.values import from_json, listing, text, whole, wholes
from amprep.threemf.package.open import open_package
from amprep.threemf.read.arrays import load_model


def read_build(path: Path) -> Build:
    """Read a build that amprep wrote, in any dialect, from the file alone.

    Only what cannot be seen in the file's objects is taken from the record. `PlacedPart.recorded_digest` is
    what the record states; whether it is that of the geometry is for `amprep.checks` to judge.

    Raises
    ------
    InputError
        If the file is hostile or broken, was not written by amprep or in another format version, or if its
        record is damaged or does not fit its objects.
    """
    package = open_package(path)
    import lib3mf

    try:
        entries = read_entries(package.data)
        _check_version(entries.model.get(record.FORMAT), path)
        return _build(load_model(package.data).model, entries)
    except lib3mf.ELib3MFException as error:
        raise InputError(f"{path}: lib3mf refuses the file ({error}); write the build again") from error
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(
            f"{path}: what amprep recorded in the file is damaged ({error}); write the build again"
        ) from error


def _check_version(version: str | None, path: Path) -> None:
    if version is None:
        raise InputError(
            f"{path}: expected a build that amprep wrote, found a 3MF without its record; "
            "give a file that amprep run made"
        )
    if version != record.FORMAT_VERSION:
        raise InputError(
            f"{path}: expected a build in format version {record.FORMAT_VERSION}, found {version[:20]!r}; "
            "use the amprep that wrote it"
        )


def _build(model: Any, entries: Entries) -> Build:
    space = record.volume_of(_recorded(entries.model, record.VOLUME))
    settings = record.settings_of(_recorded(entries.model, record.SETTINGS), space)
    known = listing(_recorded(entries.model, record.PARTS), record.PARTS)
    pieces = PieceReader(model).pieces([_recorded(entry, record.PIECES) for entry in entries.items])
    parts = _placed_parts([piece for piece in pieces if piece.role == "part"], known)
    supports = _supports([piece for piece in pieces if piece.role == "support"], len(parts))
    regions = listing(_recorded(entries.model, record.UNSUPPORTED), record.UNSUPPORTED)
    return Build(
        settings, parts, supports, tuple(record.unsupported_of(each, len(parts)) for each in regions)
    )


def _recorded(entries: dict[str, str], name: str) -> Any:
    if name not in entries:
        raise ValueError(f"{name} is missing")
    return from_json(entries[name])


def _placed_parts(pieces: Sequence[Piece], known: Sequence[Any]) -> tuple[PlacedPart, ...]:
    """Return the parts in their order in the build; copies with the same geometry share one `Part`."""
    shared: dict[tuple[int, str], Part] = {}
    placed = []
    for piece in _in_order(pieces):
        number = whole(piece.record, "part", below=len(known))
        key = (number, piece.mesh.digest)
        if key not in shared:
            shared[key] = record.part_of(known[number], piece.mesh, piece.colours)
        placed.append(_placed_part(piece, shared[key]))
    if len({each.label for each in placed}) < len(placed):
        raise ValueError("two parts have the same label")
    return tuple(placed)


def _placed_part(piece: Piece, part: Part) -> PlacedPart:
    own = piece.record.get("orientations")
    return PlacedPart(
        text(piece.record, "label"),
        part,
        piece.matrix,
        part.orientations if own is None else record.orientations_of(own),
        text(piece.record, "sha256"),
    )


def _supports(pieces: Sequence[Piece], parts: int) -> tuple[SupportBody, ...]:
    return tuple(_support(piece, parts) for piece in _in_order(pieces))


def _support(piece: Piece, parts: int) -> SupportBody:
    """Return a support; one of beams is as a whole what the file shows to readers that know none."""
    lattice, place = piece.lattice, piece.matrix
    if lattice is not None:
        nodes, solids, stand_in = (
            Mesh(lattice.nodes, np.empty((0, 3), np.int32)).moved(place).vertices,
            lattice.solids.moved(place),
            lattice.stand_in.moved(place),
        )
        lattice = replace(lattice, nodes=nodes, solids=solids, stand_in=stand_in)
    mesh = piece.mesh.moved(place) if lattice is None else lattice.stand_in
    holds = wholes(piece.record, "holds", below=parts)
    return SupportBody(text(piece.record, "name"), mesh, holds, piece.surface, lattice)


def _in_order(pieces: Sequence[Piece]) -> list[Piece]:
    """Return the pieces by their recorded index; every index must be there once."""
    ordered = sorted(pieces, key=lambda piece: whole(piece.record, "index"))
    if [piece.record["index"] for piece in ordered] != list(range(len(ordered))):
        raise ValueError("the recorded pieces are not numbered one after the other")
    return ordered
