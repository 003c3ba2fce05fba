"""Measure in what two builds differ: parts, positions, supports, listed overhangs and settings."""

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Floats
from amprep.measures.differences.records import (
    BuildDifferences,
    Change,
    ListedDifference,
    PartDifference,
    SettingDifference,
    SupportDifference,
)
from amprep.model.build import Build, BuildSettings, PlacedPart, SupportBody, Unsupported
from amprep.model.mesh import Mesh

_LEAST_ANGLE_DEG = 0.01


def find_differences(before: Build, after: Build) -> BuildDifferences:
    """Return in what a build differs from an earlier one.

    Parts are compared by their labels, supports by the parts that they hold. Coordinates count as equal up to
    `CONTACT_TOLERANCE`, because each dialect of build files rounds in its own way.

    Parameters
    ----------
    before, after
        The builds.
    """
    return BuildDifferences(
        tuple(_parts(before, after)),
        tuple(_supports(before, after)),
        tuple(_listed(before, after)),
        settings_differences(before.settings, after.settings),
    )


def _parts(before: Build, after: Build) -> Iterator[PartDifference]:
    old = {each.label: each for each in before.parts}
    new = {each.label: each for each in after.parts}
    for label, part in old.items():
        if label not in new:
            yield PartDifference(label, "removed")
        else:
            yield from _changes(part, new[label])
    for label in new:
        if label not in old:
            yield PartDifference(label, "added")


def _changes(before: PlacedPart, after: PlacedPart) -> Iterator[PartDifference]:
    """Yield what happened to one part."""
    if not _same_shape(before.part.mesh, after.part.mesh):
        yield PartDifference(before.label, "other geometry")
        return
    moved = _greatest_move(before.part.mesh, before.matrix, after.matrix)
    turned = _angle_deg(before.matrix[:3, :3].T @ after.matrix[:3, :3])
    if moved > CONTACT_TOLERANCE:
        change: Change = "turned" if turned > _LEAST_ANGLE_DEG else "moved"
        yield PartDifference(before.label, change, moved, turned if change == "turned" else 0.0)


def _same_shape(before: Mesh, after: Mesh) -> bool:
    if before.triangles.shape != after.triangles.shape or before.vertices.shape != after.vertices.shape:
        return False
    near = np.abs(before.vertices - after.vertices).max(initial=0.0) <= CONTACT_TOLERANCE
    return bool(near) and np.array_equal(before.triangles, after.triangles)


def _greatest_move(mesh: Mesh, before: Floats, after: Floats) -> float:
    """Return the largest distance (mm) of a vertex between two placements ``(4, 4)``."""
    if not len(mesh.vertices):
        return 0.0
    change = after[:3] - before[:3]
    return float(np.linalg.norm(mesh.vertices @ change[:, :3].T + change[:, 3], axis=1).max())


def _angle_deg(rotation: Floats) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(rotation) - 1.0) / 2.0, -1.0, 1.0))))


def _supports(before: Build, after: Build) -> Iterator[SupportDifference]:
    old, new = _by_parts(before), _by_parts(after)
    for parts in sorted(old.keys() | new.keys()):
        bodies = old.get(parts, []), new.get(parts, [])
        equal = len(bodies[0]) == len(bodies[1]) and all(
            _same_shape(one.mesh, other.mesh) for one, other in zip(*bodies, strict=True)
        )
        if not equal:
            volumes = [sum(abs(body.mesh.signed_volume) for body in each) for each in bodies]
            yield SupportDifference(parts, *volumes)


def _by_parts(build: Build) -> Mapping[tuple[str, ...], list[SupportBody]]:
    """Return the supports of a build by the labels of the parts that they hold."""
    found: dict[tuple[str, ...], list[SupportBody]] = {}
    for body in build.supports:
        found.setdefault(tuple(build.parts[part].label for part in body.parts), []).append(body)
    return found


def _listed(before: Build, after: Build) -> Iterator[ListedDifference]:
    sums = [_sums(each) for each in (before, after)]
    for part in sorted(sums[0].keys() | sums[1].keys()):
        (old, old_count), (new, new_count) = (each.get(part, (0.0, 0)) for each in sums)
        if old_count != new_count or abs(old - new) > CONTACT_TOLERANCE * max(1.0, old):
            yield ListedDifference(part, old, new, old_count, new_count)


def _sums(build: Build) -> dict[str, tuple[float, int]]:
    """Return for each part with listed overhangs their area, and the number of all regions."""
    found: dict[str, tuple[float, int]] = {}
    for region in build.unsupported:
        if not region.minor:
            area, count = found.get(build.parts[region.part].label, (0.0, 0))
            found[build.parts[region.part].label] = area + _area(region), count + 1
    return found


def _area(region: Unsupported) -> float:
    return region.measure if region.kind not in ("edge", "tip") else 0.0


def settings_differences(before: BuildSettings, after: BuildSettings) -> tuple[SettingDifference, ...]:
    """Return the settings of a build that differ from those of an earlier one, their names with dots."""
    return tuple(_settings(before, after))


def _settings(before: Any, after: Any, within: str = "") -> Iterator[SettingDifference]:
    """Yield the fields of a record that another of its kind has with other values; arrays are compared by value."""
    for field in fields(before):
        name = f"{within}{field.name}"
        old, new = getattr(before, field.name), getattr(after, field.name)
        if is_dataclass(old) and isinstance(new, type(old)):
            yield from _settings(old, new, f"{name}.")
        elif isinstance(old, Mapping) and isinstance(new, Mapping):
            yield from _keys(old, new, f"{name}.")
        elif not np.array_equal(old, new):
            yield SettingDifference(name, _plain(old), _plain(new))


def _keys(before: Mapping[str, Any], after: Mapping[str, Any], within: str) -> Iterator[SettingDifference]:
    """Yield the keys of two tables that differ; those of files that record none are not compared."""
    for key in sorted(before.keys() | after.keys()) if before and after else ():
        old, new = before.get(key), after.get(key)
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            yield from _keys(old, new, f"{within}{key}.")
        elif old != new:
            yield SettingDifference(f"{within}{key}", old, new)


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value
