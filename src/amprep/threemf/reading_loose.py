"""Modifiers and blockers that lie on the plate by themselves, as Cura has them: they belong to the parts they meet."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from amprep.model.arrays import Floats
from amprep.model.mesh import Mesh
from amprep.model.part import Part, Region
from amprep.threemf.reading_slicer import BLOCKER, MODIFIER, Role
from amprep.threemf.writing_components import CURA_NAMESPACE

Loose = tuple[Region, Floats]
"""A region in mm, and the positions ``(k, 3)`` at which it lies."""

_SETTINGS = {"infill_mesh": MODIFIER, "cutting_mesh": MODIFIER, "anti_overhang_mesh": BLOCKER}


def cura_role(metadata: Mapping[tuple[str, str], str], name: str) -> Role | None:
    """Return what Cura's settings of an object make of it; None for a part."""
    for setting, kind in _SETTINGS.items():
        if metadata.get((CURA_NAMESPACE, setting), "").strip().lower() == "true":
            return Role(kind, name)
    return None


def with_loose(parts: Sequence[Part], loose: Sequence[Loose]) -> list[Part]:
    """Return the parts, each with the regions whose boxes meet the box around one of its places."""
    return [
        replace(part, regions=(*part.regions, *(each for one in loose for each in _on(part, *one))))
        for part in parts
    ]


def _on(part: Part, region: Region, places: Floats) -> list[Region]:
    if region.mesh is None or part.positions is None:
        return []
    (low, high), (part_low, part_high) = region.mesh.bounds, part.mesh.bounds
    shifts = [place - at for at in part.positions for place in places]
    met = [each for each in shifts if (low + each < part_high).all() and (high + each > part_low).all()]
    different = np.unique(np.round(np.array(met).reshape(-1, 3), 6), axis=0)
    mesh = region.mesh
    return [replace(region, mesh=Mesh(mesh.vertices + each, mesh.triangles)) for each in different]
