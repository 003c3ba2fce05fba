"""Write the labels of a job on its parts."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from amprep.errors import InputError, JobError, nearest_hint
from amprep.geometry.labels.faces import find_flat_faces
from amprep.geometry.labels.font import unknown_in
from amprep.geometry.labels.text_solid import (
    LEAST_WALL_MM,
    OBSTRUCTED,
    TOO_SMALL,
    TOO_THIN,
    TextSize,
    write_on,
)
from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.manifold import as_manifold
from amprep.job.labels import LabelSettings, read_labels
from amprep.model import Mesh, Part
from amprep.model.counting import counted

_MOST_FACES = 20
"""Faces that are tried, the largest first."""


def labelled(parts: Sequence[Part], file: Path | None) -> list[Part]:
    """Return the parts with their labels; copies with different labels become parts of their own.

    Parameters
    ----------
    parts
        Parts of the job, with unique names.
    file
        The list of labels; None for none.

    Raises
    ------
    JobError
        If the list is wrong, or a row names no part or copy.
    InputError
        If no face of a part holds its label; the message says why.
    """
    if file is None:
        return list(parts)
    rows = read_labels(file)
    for row in rows:
        _require_named(row, parts, f"{file}: row {row.row}")
    return [made for part in parts for made in _with_labels(part, rows, file)]


def _require_named(row: LabelSettings, parts: Sequence[Part], where: str) -> None:
    copies = [part.quantity for part in parts if row.is_for(part.name, row.copy or 1)]
    if not copies:
        near = nearest_hint(row.part, [part.name for part in parts])
        raise JobError(f"{where}: no part is called {row.part!r}{near}")
    if row.copy is not None and row.copy > max(copies):
        raise JobError(
            f"{where}: {row.part} has {counted(max(copies), 'copy', 'copies')}, no copy {row.copy}"
        )


def _with_labels(part: Part, rows: Sequence[LabelSettings], file: Path) -> list[Part]:
    """Return a part with its labels: one part, or one for each copy if their labels differ."""
    own = [row for row in rows if any(row.is_for(part.name, copy) for copy in range(1, part.quantity + 1))]
    if not own:
        return [part]
    if not any(row.differs for row in own):
        return [_labelled(part, part, 1, own, file)]
    singles = [_copy_of(part, number) for number in range(part.quantity)]
    return [
        _labelled(single, part, copy, [row for row in own if row.is_for(part.name, copy)], file)
        for copy, single in enumerate(singles, start=1)
    ]


def _copy_of(part: Part, number: int) -> Part:
    """Return one copy of a part as a part of its own, with its own position."""
    one = slice(number, number + 1)
    positions = None if part.positions is None else part.positions[one]
    fixed = None if part.fixed is None or number >= len(part.fixed) else part.fixed[one]
    positions = None if positions is not None and not len(positions) else positions
    return replace(part, quantity=1, positions=positions, fixed=fixed)


def _labelled(single: Part, part: Part, copy: int, rows: Sequence[LabelSettings], file: Path) -> Part:
    for row in rows:
        single = _written(single, row.text_for(part.name, copy, part.quantity), row, f"{file}: row {row.row}")
    return single


def _written(part: Part, text: str, row: LabelSettings, where: str) -> Part:
    """Return a part with one label on the largest of the faces that hold it."""
    _refuse_unsuitable(part, text, where)
    solid = as_manifold(*part.mesh.arrays)
    size = TextSize(text, row.height_mm, row.depth_mm if row.kind == "engraved" else -row.depth_mm)
    faces = [each for each in find_flat_faces(*part.mesh.arrays) if row.face is None or each.looks(row.face)]
    faces = faces[:_MOST_FACES]
    reasons = []
    for face in faces if row.place else [*faces, *(each.turned() for each in faces)]:
        made = write_on(solid, face, size, row.place)
        if isinstance(made, str):
            reasons.append(made)
            continue
        x, y, z = (round(float(value), 2) for value in face.normal)
        note = (
            f"label {text!r} {row.kind} by {row.depth_mm:g} mm on the face with the normal ({x:g}, {y:g}, {z:g}); "
            "the SHA-256 of the part is that with its label"
        )
        mesh = Mesh(*arrays_of(made))
        return replace(part, mesh=mesh, volume_mm3=float(made.volume()), notes=(*part.notes, note))
    width, height = size.extent
    raise InputError(
        f"{where}: no face of {part.name} holds {text!r} of {width:.1f} x {height:.1f} mm: "
        f"{_why(reasons, row)}; write less, smaller letters, or another face"
    )


def _refuse_unsuitable(part: Part, text: str, where: str) -> None:
    if unknown_in(text):
        raise JobError(f"{where}: the font has no {unknown_in(text)!r}, which the name of the part contains")
    if not part.is_solid:
        raise InputError(f"{where}: {part.name} is not a solid, so it cannot be labelled")
    painted = any(region.triangles is not None for region in part.regions)
    if painted or part.appearance.triangle_colours is not None:
        raise InputError(f"{where}: {part.name} has painted triangles, which a label would renumber")


def _why(reasons: Sequence[str], row: LabelSettings) -> str:
    """Return why no face holds a label: what the face that came nearest lacks."""
    looks = "up or to the side" if row.face is None else f"to {row.face!r}"
    words = {
        OBSTRUCTED: "something of the part is in front of the face",
        TOO_THIN: f"the wall behind it is thinner than {row.depth_mm + LEAST_WALL_MM:g} mm"
        if row.kind == "engraved"
        else f"the wall behind it is thinner than {LEAST_WALL_MM:g} mm",
        TOO_SMALL: f"the flat faces that look {looks} are too small",
    }
    nearest = next((reason for reason in words if reason in reasons), "")
    return words.get(nearest, f"no flat face looks {looks}")
