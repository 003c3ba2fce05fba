"""Assign regions that are build items of their own, as in Cura's files, to the parts that they touch."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.model.mesh import Mesh
from amprep.model.part import Part, Region


class SeparateRegion(NamedTuple):
    """A region that belongs to no object with printed triangles, and its positions ``(k, 3)`` mm."""

    region: Region
    positions: Floats


def assign_regions(parts: Sequence[Part], separate: Sequence[SeparateRegion]) -> list[Part]:
    """Return the parts, each with the regions whose bounding boxes overlap that of one of its instances."""
    return [
        replace(
            part, regions=(*part.regions, *(each for region in separate for each in _on_part(part, region)))
        )
        for part in parts
    ]


def _on_part(part: Part, separate: SeparateRegion) -> list[Region]:
    """Return the region in part coordinates, once for each different position relative to the part."""
    mesh = separate.region.mesh
    if mesh is None or part.positions is None:
        return []
    (low, high), (part_low, part_high) = mesh.bounds, part.mesh.bounds
    shifts = [position - at for at in part.positions for position in separate.positions]
    overlapping = [
        each for each in shifts if (low + each < part_high).all() and (high + each > part_low).all()
    ]
    different = np.unique(np.round(np.array(overlapping).reshape(-1, 3), 6), axis=0)
    return [replace(separate.region, mesh=Mesh(mesh.vertices + each, mesh.triangles)) for each in different]
