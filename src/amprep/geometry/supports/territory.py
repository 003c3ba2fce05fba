"""Regions of the plate in which the supports of a part may stand, and the columns of voxels inside them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools
from amprep.geometry.plates.shadow import SEGMENTS
from amprep.geometry.supports.footprints import union_of
from amprep.geometry.voxels.grid import Grid
from amprep.geometry.voxels.voxelise import centred_voxels, met_voxels

if TYPE_CHECKING:
    from manifold3d import CrossSection

SIMPLE = 1e-4
"""Distance (mm) up to which corners of outlines are left out."""


class Columns(NamedTuple):
    """Columns of voxels and a region of the plate.

    Attributes
    ----------
    whole, touched, centred
        ``(ny, nx)`` bool: columns inside the region, columns that it touches, and columns with their axis inside it.
    """

    whole: Bools
    touched: Bools
    centred: Bools


def territory_region(
    own: "CrossSection", others: Sequence["CrossSection"], boxes: Sequence["CrossSection"], margin: float
) -> "CrossSection":
    """Return the region in which the supports of a part may stand.

    It is the shadow of the part grown by a margin, without the shadows of other parts (where they are not in its own
    shadow) and without the boxes of other parts.

    Parameters
    ----------
    own, others
        Shadows of the part and of other parts.
    boxes
        Rectangles that are closed.
    margin
        mm.
    """
    from manifold3d import JoinType

    own = own.simplify(SIMPLE)
    wider = own.offset(margin, JoinType.Round, 2.0, SEGMENTS) if margin > 0.0 else own
    if others:
        wider -= union_of(others) - own
    if boxes:
        wider -= union_of(boxes)
    return wider.simplify(SIMPLE)


def columns_of(region: "CrossSection", grid: Grid) -> Columns:
    """Return the columns of the voxels of a grid that a region contains or touches.

    The region is extruded and voxelised in one layer, so that contact of up to 0.001 mm does not count.
    """
    found = Columns(*(np.zeros(grid.shape[1:], np.bool_) for _ in range(3)))
    if region.is_empty():
        return found
    layer = Grid(grid.origin * (1.0, 1.0, 0.0), grid.pitch, 1.0, (1, *grid.shape[1:]))
    mesh = region.extrude(3.0).translate((0.0, 0.0, -1.0)).to_mesh64()
    points, triangles = np.asarray(mesh.vert_properties[:, :3]), np.asarray(mesh.tri_verts, np.int64)
    block = layer.block(points.min(axis=0), points.max(axis=0))
    crossed = met_voxels(block, points, triangles, solid=False)
    centred = centred_voxels(block, points, triangles)
    _, y, x = block.slices
    for columns, chosen in zip(found, (centred & ~crossed, centred | crossed, centred), strict=True):
        columns[y, x] = chosen.any(axis=0)
    return found
