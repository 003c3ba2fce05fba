"""Convert the records of a build to the JSON in a build file's metadata, and back."""

from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import PurePath
from typing import Any, Literal, cast, get_args

import numpy as np

from amprep.geometry.meshes.sampling import triangle_areas
from amprep.model.build import (
    TARGETS,
    Build,
    BuildSettings,
    SupportBody,
    SupportsAs,
    Target,
    Unsupported,
)
from amprep.model.build_volume import BuildVolume
from amprep.model.mesh import Mesh
from amprep.model.part import Appearance, Freedom, Orientations, Overrides, Part, Region, RegionKind
from amprep.model.supports.rules import Grounding, OverhangJudgement, SupportRules, Territory
from amprep.model.supports.sizes import SupportSizes
from amprep.threemf.build.values import (
    JsonObject,
    as_list,
    as_object,
    boolean,
    choice,
    integer,
    integers,
    number,
    plain,
    string,
    table,
)
from amprep.validation import LARGEST_COORDINATE, LARGEST_LENGTH, LARGEST_OVERLAP, LEAST_REACH

FORMAT_VERSION = "1"
"""Version of the metadata; a file with another version is refused."""

FORMAT, SETTINGS, VOLUME, PARTS, UNSUPPORTED = "format", "settings", "volume", "parts", "unsupported"
CONTENTS, IDENTIFIER, PLANNING, DIGEST = "contents", "identifier", "planning", "digest"
"""Names of the model's metadata in amprep's namespace."""

BODIES = "bodies"
"""Name of a build item's metadata in amprep's namespace: its parts and supports, in the order of their geometry."""

HOLDS = "holds"
"""Name of a support object's metadata in amprep's namespace: the labels of the parts that it holds."""


def numbered(name: str, number: int) -> str:
    """Return the name of section `number`, from 1, of a metadata entry that is split because of its length."""
    return name if number == 1 else f"{name}.{number}"


_SETTING_STRINGS = ("build_id", "printer")
_SETTING_NUMBERS = ("clearance", "lift", "overlap", "reach")
_BOUNDS = {
    **dict.fromkeys(("clearance", "lift", "gap_mm", "radius"), (0.0, LARGEST_LENGTH)),
    **dict.fromkeys(("clearance_mm", "lift_mm", "territory_margin_mm"), (0.0, LARGEST_LENGTH)),
    "overlap": (0.0, LARGEST_OVERLAP),
    "reach": (LEAST_REACH, LARGEST_LENGTH),
    "overhang_angle_deg": (0.0, 89.0),
    "measure": (0.0, LARGEST_COORDINATE**2),
    "volume_mm3": (0.0, LARGEST_COORDINATE**3),
    "value": (-(LARGEST_COORDINATE**3), LARGEST_COORDINATE**3),
}
"""Least and greatest values of numbers in a record, those of the job file's keys; `SupportRules` checks its own."""
_RULE_NUMBERS = ("overhang_angle_deg", "strut_angle_deg", "min_area_mm2", "min_length_mm", "gap_mm")
_LATER_RULE_NUMBERS = (
    *("noncritical_angle_deg", "ledge_mm", "bridge_mm", "bore_mm", "plate_mm", "layer_mm"),
    *("least_wall_mm", "least_contact_mm2", "leg_ratio", "contact_spacing_mm"),
    *("territory_margin_mm", "drift_ratio", "drift_mm"),
)
_LATER_RULE_CHOICES = {"rules": get_args(OverhangJudgement), "territory": get_args(Territory)}
_RULE_NAMES = (*_RULE_NUMBERS, *_LATER_RULE_NUMBERS, *_LATER_RULE_CHOICES, "grounding")
_OVERRIDE_NUMBERS = ("overhang_angle_deg", "lift_mm", "clearance_mm", "territory_margin_mm")


def settings_record(settings: BuildSettings) -> JsonObject:
    """Return the settings of a build without its build volume."""
    names = ("build_id", "target", "printer", *_SETTING_NUMBERS, "supported", "supports_as")
    rules = {name: getattr(settings.rules, name) for name in _RULE_NAMES}
    sizes = {"sizes": asdict(settings.sizes)}
    origin = {"plate_origin": list(settings.plate_origin)} if any(settings.plate_origin) else {}
    return {name: getattr(settings, name) for name in names} | rules | sizes | origin


def settings_of(record: Any, space: BuildVolume) -> BuildSettings:
    """Return the settings of a build; like all readers below, raise ValueError for a value of the wrong type."""
    values = as_object(record, SETTINGS)
    strings = {name: string(values, name) for name in _SETTING_STRINGS}
    numbers = {name: _bounded(values, name) for name in _SETTING_NUMBERS}
    target = cast("Target", choice(values, "target", TARGETS))
    grounding = cast("Grounding", choice(values, "grounding", get_args(Grounding)))
    limits: dict[str, Any] = {name: _bounded(values, name) for name in _RULE_NUMBERS}
    limits |= {name: number(values, name) for name in _LATER_RULE_NUMBERS if name in values}
    limits |= {
        name: choice(values, name, known) for name, known in _LATER_RULE_CHOICES.items() if name in values
    }
    supports_as = cast(
        "SupportsAs",
        choice(values, "supports_as", get_args(SupportsAs)) if "supports_as" in values else "support",
    )
    supported = boolean(values, "supported")
    sizes = sizes_of(values.get("sizes", {}))
    x, y = table(values, "plate_origin", 2).ravel().tolist() if "plate_origin" in values else (0.0, 0.0)
    if not max(abs(x), abs(y)) <= LARGEST_COORDINATE:
        raise ValueError(f"plate_origin must be within {LARGEST_COORDINATE:g} of 0")
    return BuildSettings(
        **strings,  # type: ignore[arg-type]
        **numbers,  # type: ignore[arg-type]
        target=target,
        supported=supported,
        rules=SupportRules(grounding=grounding, **limits),
        supports_as=supports_as,
        space=space,
        sizes=sizes,
        plate_origin=(x, y),
    )


def contents_record(build: Build) -> JsonObject:
    """Return the numbers of bodies, so that a body that is removed with its record is missed."""
    return {"parts": len(build.parts), "supports": len(build.supports)}


def check_contents(record: Any, parts: int, supports: int) -> None:
    """Raise ValueError unless a file has as many parts and supports as it records."""
    values = as_object(record, CONTENTS)
    for name, found in (("parts", parts), ("supports", supports)):
        if integer(values, name) != found:
            raise ValueError(f"{values[name]} {name} are recorded, the file has {found}")


def support_record(index: int, support: SupportBody, digest: str) -> JsonObject:
    """Return the record of a support; reach and sizes only if they are its own.

    Parameters
    ----------
    index
        Index of the support in the build.
    support
        The support.
    digest
        SHA-256 of the geometry that a reader of the file gets.
    """
    own: JsonObject = {} if support.reach is None else {"reach": support.reach}
    sizes = {} if support.sizes is None else {"sizes": asdict(support.sizes)}
    entry = {"role": "support", "index": index, "name": support.name, "holds": list(support.parts)}
    entry |= {"surface": support.surface, "sha256": digest}
    return {**entry, **own, **sizes}


def own_reach(record: JsonObject) -> float | None:
    """Return the reach that a support states for itself, None where it states none."""
    return _number_or_none(record, "reach")


def sizes_of(record: Any) -> SupportSizes:
    """Return the sizes of supports; older files have none."""
    values = as_object(record, "sizes")
    known = [each.name for each in fields(SupportSizes) if each.name in values]
    return SupportSizes(**{name: number(values, name) for name in known})


def volume_record(space: BuildVolume) -> JsonObject:
    """Return size, shape and forbidden zones of a build volume; a zone is x0, y0, z0, x1, y1, z1 in mm."""
    zones = np.hstack([space.zone_lo, space.zone_hi])
    return {"size": plain(space.size), "shape": space.shape, "zones": plain(zones)}


def volume_of(record: Any) -> BuildVolume:
    """Return the build volume."""
    values = as_object(record, VOLUME)
    shape = cast('Literal["box", "cylinder"]', choice(values, "shape", ("box", "cylinder")))
    zones = table(values, "zones", 6)
    return BuildVolume(table(values, "size", 3).reshape(-1), shape, zones[:, :3], zones[:, 3:])


def orientations_record(orientations: Orientations) -> JsonObject:
    """Return the freedom and the rotation matrices, nine numbers each in row-major order."""
    return {"freedom": orientations.freedom, "matrices": plain(orientations.matrices.reshape(-1, 9))}


def orientations_of(record: Any) -> Orientations:
    """Return the allowed orientations."""
    values = as_object(record, "orientations")
    freedom = cast("Freedom", choice(values, "freedom", get_args(Freedom)))
    return Orientations(freedom, table(values, "matrices", 9).reshape(-1, 3, 3))


def part_record(part: Part) -> JsonObject:
    """Return a part without its mesh and the colours of its triangles.

    `source` is reduced to the file's name, so that a build's bytes do not depend on the job's folder.
    Regions to be filled with cells are left out because no judge needs them.
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
        **({"source_sha256": part.source_sha256} if part.source_sha256 else {}),
        "notes": list(part.notes),
        "regions": [_region_record(region) for region in part.regions if region.kind != "lattice"],
        "metadata": [[namespace, name, value] for (namespace, name), value in part.metadata.items()],
    }


def part_of(record: Any, mesh: Mesh, triangle_colours: Any | None) -> Part:
    """Return a part.

    Parameters
    ----------
    record
        The JSON object that `part_record` made.
    mesh, triangle_colours
        Geometry and colours ``(m, 3)`` of the part's object in the file.
    """
    values = as_object(record, "part")
    colour, material = (_string_or_none(values, name) for name in ("colour", "material"))
    return Part(
        name=string(values, "name"),
        mesh=mesh,
        volume_mm3=_bounded(values, "volume_mm3"),
        quantity=integer(values, "quantity"),
        value=_number_or_none(values, "value"),
        orientations=orientations_of(values.get("orientations")),
        regions=tuple(_region_of(entry, mesh) for entry in as_list(values.get("regions"), "regions")),
        overrides=_overrides_of(values.get("overrides")),
        appearance=Appearance(colour, material, triangle_colours),
        is_solid=boolean(values, "is_solid"),
        boxes=None if values.get("boxes") is None else table(values, "boxes", 6),
        part_number=string(values, "part_number"),
        source=string(values, "source"),
        source_sha256=string(values, "source_sha256") if "source_sha256" in values else "",
        notes=tuple(_strings(values.get("notes"), "notes")),
        metadata=_metadata_of(values.get("metadata")),
    )


def unsupported_record(region: Unsupported) -> JsonObject:
    """Return an unsupported region; its points are rounded to 1e-6 mm."""
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
    """Return an unsupported region of a build with `parts` parts."""
    values = as_object(record, UNSUPPORTED)
    return Unsupported(
        part=integer(values, "part", below=parts),
        label=string(values, "label"),
        kind=choice(values, "kind", ("face", "edge", "tip")),
        reason=string(values, "reason"),
        measure=_bounded(values, "measure"),
        points=table(values, "points", 3),
        radius=_bounded(values, "radius"),
        minor="minor" in values and boolean(values, "minor"),
    )


def _overrides_record(overrides: Overrides) -> JsonObject:
    """Return the settings of a part that matter once it is packed; its volume makers do not."""
    names = (*_OVERRIDE_NUMBERS, "supports")
    return {name: getattr(overrides, name) for name in names if getattr(overrides, name) is not None}


def _overrides_of(record: Any) -> Overrides:
    values = as_object(record, "overrides")
    numbers: dict[str, Any] = {name: _number_or_none(values, name) for name in _OVERRIDE_NUMBERS}
    return Overrides(**numbers, supports=boolean(values, "supports") if "supports" in values else None)


def _region_record(region: Region) -> JsonObject:
    record: dict[str, Any] = {"kind": region.kind, "name": region.name}
    if region.triangles is not None:
        record["triangles"] = region.triangles.tolist()
    if region.mesh is not None:
        record["mesh"] = [plain(region.mesh.vertices, decimals=6), region.mesh.triangles.tolist()]
    return record


def _region_of(record: Any, part: Mesh) -> Region:
    """Return a region of a part with a mesh."""
    values = as_object(record, "region")
    kind = cast("RegionKind", choice(values, "kind", get_args(RegionKind)))
    triangles = None
    if "triangles" in values:
        triangles = np.array(integers(values, "triangles", below=len(part.triangles)), np.int32)
    mesh = _region_mesh(values) if "mesh" in values else None
    if mesh is not None and triangles is not None:
        _require_painted(mesh, part, len(triangles))
    return Region(kind, string(values, "name"), triangles, mesh)


def _region_mesh(values: JsonObject) -> Mesh:
    """Return the mesh of a region, whose triangles must have vertices."""
    vertices, corners = as_list(values["mesh"], "mesh")
    points = table({"mesh": vertices}, "mesh", 3)
    flat = [corner for triangle in as_list(corners, "mesh") for corner in as_list(triangle, "mesh")]
    indices = np.array(integers({"mesh": flat}, "mesh", below=len(points)), np.int32)
    if len(indices) != 3 * len(corners):
        raise ValueError("the triangles of a region's mesh must have three corners each")
    return Mesh(points, indices.reshape(-1, 3))


def _require_painted(mesh: Mesh, part: Mesh, count: int) -> None:
    """Raise ValueError unless painted areas have a triangle of the part each, and no more area than the part."""
    if len(mesh.triangles) != count:
        raise ValueError(f"a region paints {count} triangles with {len(mesh.triangles)} areas")
    area, whole = (triangle_areas(each.vertices[each.triangles]).sum() for each in (mesh, part))
    if area > 1.01 * whole + 1e-3:
        raise ValueError(f"a region paints {area:.6g} mm2 of a part of {whole:.6g} mm2")


def _metadata_of(record: Any) -> dict[tuple[str, str], str]:
    entries = [_strings(entry, "metadata") for entry in as_list(record, "metadata")]
    return {(namespace, name): value for namespace, name, value in entries}


def _strings(record: Any, name: str) -> Sequence[str]:
    values = as_list(record, name)
    if not all(isinstance(value, str) for value in values):
        raise ValueError(f"{name} must be a list of strings")
    return values


def _string_or_none(values: JsonObject, name: str) -> str | None:
    return None if values.get(name) is None else string(values, name)


def _number_or_none(values: JsonObject, name: str) -> float | None:
    return None if values.get(name) is None else _bounded(values, name)


def _bounded(values: JsonObject, name: str) -> float:
    """Return the number called `name` within its bounds, if it has any."""
    return number(values, name, *_BOUNDS.get(name, ()))
