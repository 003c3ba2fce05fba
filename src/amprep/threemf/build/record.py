"""What amprep writes about a build into its 3MF: namespace, names of the metadata, records of the model."""

from collections.abc import Sequence
from pathlib import PurePath
from typing import Any, Literal, cast, get_args

import numpy as np

from amprep.model.build import TARGETS, BuildSettings, Grounding, SupportsAs, Target, Unsupported
from amprep.model.build_volume import BuildVolume
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance, Freedom, Orientations, Overrides, Part, Region, RegionKind
from amprep.threemf.build.values import (
    Record,
    flag,
    listing,
    mapping,
    number,
    plain,
    table,
    text,
    whole,
    wholes,
    word,
)

NAMESPACE = "http://schemas.amprep.dev/3mf/2026/11"
"""Namespace of all metadata that amprep reads from jobs and writes into builds."""

FORMAT_VERSION = "1"
"""Version of the record; a file with another one is refused by name."""

FORMAT, SETTINGS, VOLUME, PARTS, UNSUPPORTED = "format", "settings", "volume", "parts", "unsupported"
"""Names of the model's metadata in `NAMESPACE`."""

PIECES = "pieces"
"""Name of a build item's metadata in `NAMESPACE`: its parts and supports, in the order of their geometry."""

HOLDS = "holds"
"""Name of a support object's metadata in `NAMESPACE`: the labels of the parts that it holds."""


def numbered(name: str, number: int) -> str:
    """Return the name of the n-th part of an entry that is cut into several."""
    return name if number == 1 else f"{name}.{number}"


_SETTING_TEXTS = ("build_id", "printer")
_SETTING_NUMBERS = (
    "clearance",
    "lift",
    "gap",
    "overlap",
    "reach",
    "overhang_angle_deg",
    "strut_angle_deg",
    "least_area",
    "least_length",
)
_OVERRIDE_NUMBERS = ("overhang_angle_deg", "lift_mm", "clearance_mm")


def settings_record(settings: BuildSettings) -> Record:
    """Return all rules of a build but its build volume."""
    names = ("build_id", "target", "printer", *_SETTING_NUMBERS, "supported", "grounding", "supports_as")
    return {name: getattr(settings, name) for name in names}


def settings_of(record: Any, space: BuildVolume) -> BuildSettings:
    """Return the rules of a build; like all readers here, raises ValueError for a value of the wrong kind."""
    values = mapping(record, SETTINGS)
    texts = {name: text(values, name) for name in _SETTING_TEXTS}
    numbers = {name: number(values, name) for name in _SETTING_NUMBERS}
    target = cast("Target", word(values, "target", TARGETS))
    grounding = cast(
        "Grounding", word(values, "grounding", get_args(Grounding)) if "grounding" in values else "plate"
    )
    supports_as = cast(
        "SupportsAs",
        word(values, "supports_as", get_args(SupportsAs)) if "supports_as" in values else "support",
    )
    supported = flag(values, "supported")
    return BuildSettings(
        **texts,  # type: ignore[arg-type]
        **numbers,  # type: ignore[arg-type]
        target=target,
        supported=supported,
        grounding=grounding,
        supports_as=supports_as,
        space=space,
    )


def volume_record(space: BuildVolume) -> Record:
    """Return size, shape and forbidden zones (x0 y0 z0 x1 y1 z1 each), mm."""
    zones = np.hstack([space.zone_lo, space.zone_hi])
    return {"size": plain(space.size), "shape": space.shape, "zones": plain(zones)}


def volume_of(record: Any) -> BuildVolume:
    """Return the build volume."""
    values = mapping(record, VOLUME)
    shape = cast('Literal["box", "cylinder"]', word(values, "shape", ("box", "cylinder")))
    zones = table(values, "zones", 6)
    return BuildVolume(table(values, "size", 3).reshape(-1), shape, zones[:, :3], zones[:, 3:])


def orientations_record(orientations: Orientations) -> Record:
    """Return freedom and rotation matrices, nine numbers each, row by row."""
    return {"freedom": orientations.freedom, "matrices": plain(orientations.matrices.reshape(-1, 9))}


def orientations_of(record: Any) -> Orientations:
    """Return the allowed orientations."""
    values = mapping(record, "orientations")
    freedom = cast("Freedom", word(values, "freedom", get_args(Freedom)))
    return Orientations(freedom, table(values, "matrices", 9).reshape(-1, 3, 3))


def part_record(part: Part) -> Record:
    """Return all that is known of a part but its mesh and the colours of its triangles.

    `source` keeps the file's name only, so that a build's bytes do not depend on where the job lay.
    Regions to be filled with cells are left out: no judge asks for them.
    """
    return {
        "name": part.name,
        "volume_mm3": part.volume_mm3,
        "quantity": part.quantity,
        "value": part.value,
        "is_solid": part.is_solid,
        "orientations": orientations_record(part.orientations),
        "overrides": _overrides_record(part.overrides),
        "colour": part.appearance.colour,
        "material": part.appearance.material,
        "boxes": None if part.boxes is None else plain(part.boxes),
        "part_number": part.part_number,
        "source": PurePath(part.source).name,
        "notes": list(part.notes),
        "regions": [_region_record(region) for region in part.regions if region.kind != "lattice"],
        "metadata": [[namespace, name, value] for (namespace, name), value in part.metadata.items()],
    }


def part_of(record: Any, mesh: Mesh, triangle_colours: Any | None) -> Part:
    """Return the part of a record with the geometry and triangle colours that the file holds for it."""
    values = mapping(record, "part")
    colour, material = (_text_or_none(values, name) for name in ("colour", "material"))
    return Part(
        name=text(values, "name"),
        mesh=mesh,
        volume_mm3=number(values, "volume_mm3"),
        quantity=whole(values, "quantity"),
        value=_number_or_none(values, "value"),
        orientations=orientations_of(values.get("orientations")),
        regions=tuple(_region_of(entry) for entry in listing(values.get("regions"), "regions")),
        overrides=_overrides_of(values.get("overrides")),
        appearance=Appearance(colour, material, triangle_colours),
        is_solid=flag(values, "is_solid"),
        boxes=None if values.get("boxes") is None else table(values, "boxes", 6),
        part_number=text(values, "part_number"),
        source=text(values, "source"),
        notes=tuple(_texts(values.get("notes"), "notes")),
        metadata=_metadata_of(values.get("metadata")),
    )


def unsupported_record(region: Unsupported) -> Record:
    """Return a listed region; its points are rounded to 1e-6 mm."""
    return {
        "part": region.part,
        "label": region.label,
        "kind": region.kind,
        "reason": region.reason,
        "measure": region.measure,
        "radius": region.radius,
        **({"minor": True} if region.minor else {}),
        "points": plain(region.points, decimals=6),
    }


def unsupported_of(record: Any, parts: int) -> Unsupported:
    """Return a listed region of one of so many `parts`."""
    values = mapping(record, UNSUPPORTED)
    return Unsupported(
        part=whole(values, "part", below=parts),
        label=text(values, "label"),
        kind=word(values, "kind", ("face", "edge", "tip")),
        reason=text(values, "reason"),
        measure=number(values, "measure"),
        points=table(values, "points", 3),
        radius=number(values, "radius"),
        minor="minor" in values and flag(values, "minor"),
    )


def _overrides_record(overrides: Overrides) -> Record:
    names = (*_OVERRIDE_NUMBERS, "supports")
    return {name: getattr(overrides, name) for name in names if getattr(overrides, name) is not None}


def _overrides_of(record: Any) -> Overrides:
    values = mapping(record, "overrides")
    numbers = {name: _number_or_none(values, name) for name in _OVERRIDE_NUMBERS}
    return Overrides(**numbers, supports=flag(values, "supports") if "supports" in values else None)


def _region_record(region: Region) -> Record:
    record: dict[str, Any] = {"kind": region.kind, "name": region.name}
    if region.triangles is not None:
        record["triangles"] = region.triangles.tolist()
    if region.mesh is not None:
        record["mesh"] = [plain(region.mesh.vertices, decimals=6), region.mesh.triangles.tolist()]
    return record


def _region_of(record: Any) -> Region:
    values = mapping(record, "region")
    kind = cast("RegionKind", word(values, "kind", get_args(RegionKind)))
    triangles = (
        np.array(wholes(values, "triangles", below=2**31), np.int32) if "triangles" in values else None
    )
    mesh = None
    if "mesh" in values:
        vertices, corners = listing(values["mesh"], "mesh")
        mesh = Mesh(vertices, corners)
    return Region(kind, text(values, "name"), triangles, mesh)


def _metadata_of(record: Any) -> dict[tuple[str, str], str]:
    entries = [_texts(entry, "metadata") for entry in listing(record, "metadata")]
    return {(namespace, name): value for namespace, name, value in entries}


def _texts(record: Any, name: str) -> Sequence[str]:
    values = listing(record, name)
    if not all(isinstance(value, str) for value in values):
        raise ValueError(f"{name} must be a list of texts")
    return values


def _text_or_none(values: Record, name: str) -> str | None:
    return None if values.get(name) is None else text(values, name)


def _number_or_none(values: Record, name: str) -> float | None:
    return None if values.get(name) is None else number(values, name)
