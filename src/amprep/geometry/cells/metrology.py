"""Measure a block of cells on voxels: its smallest feature, and the largest ball that escapes from it."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.meshes.containment import inside

_THIN_FRACTION = 0.01
"""Fraction of the volume of the cells that may be thinner than the smallest feature."""

_TRAPPED_FRACTION = 0.05
"""Fraction of the powder that may stay in corners which the ball does not reach."""

_CORNER = 1.75
"""A ball in the corner of a cube leaves points up to sqrt(3) times its radius from its centre; 1.75 exceeds that."""


def smallest_feature(
    meshes: Sequence[MeshArrays], template: Int64s, place: Int64s, size: Floats, steps: int
) -> float | None:
    """Return the smallest feature of a block (mm), accurate to a voxel; None for an empty block.

    Parameters
    ----------
    meshes
        Closed meshes in the unit cube.
    template, place
        ``(n,)`` mesh of each cell, and ``(n, 3)`` its position in the block (x, y, layer), from 0.
    size
        ``(3,)`` mm, of a cell.
    steps
        Voxels along each edge of a cell.
    """
    return _smallest_feature(_block(meshes, template, place, steps), size / steps)


def escape_diameter(
    meshes: Sequence[MeshArrays], template: Int64s, place: Int64s, size: Floats, steps: int
) -> tuple[float | None, float]:
    """Return the diameter of the largest ball that escapes sideways from most of the void, and the closed fraction.

    The plate closes the block from below and the part closes it from above.

    Parameters
    ----------
    meshes, template, place, size, steps
        As for `smallest_feature`.

    Returns
    -------
    diameter, pocket
        Diameter in mm, None without any void; and the fraction of the block that is void without an escape channel.
    """
    return _escape_diameter(~_block(meshes, template, place, steps), size / steps)


def _block(meshes: Sequence[MeshArrays], template: Int64s, place: Int64s, steps: int) -> Bools:
    """Tell which voxels of the block are solid."""
    cubes = [_voxels(mesh, steps) for mesh in meshes]
    extent = place.max(axis=0) + 1
    block = np.zeros(tuple((extent * steps).tolist()), np.bool_)
    for index, (x, y, z) in zip(template.tolist(), (place * steps).tolist(), strict=True):
        block[x : x + steps, y : y + steps, z : z + steps] |= cubes[index]
    return block


def _voxels(mesh: MeshArrays, steps: int) -> Bools:
    """Tell which voxels have their centre inside the mesh."""
    middles = (np.arange(steps) + 0.5) / steps
    centres = np.stack(np.meshgrid(middles, middles, middles, indexing="ij"), axis=-1).reshape(-1, 3)
    # away from the symmetry planes, which often contain vertices
    points, triangles = mesh
    found = inside(centres + 1e-7 * np.array([1.0, 1.7, 2.3]), points, triangles.astype(np.int32))
    return found.reshape(steps, steps, steps)


def _smallest_feature(solid: Bools, spacing: Floats) -> float | None:
    """Return the largest diameter of a ball that reaches all of the solid but its corners, by bisection."""
    from scipy.ndimage import distance_transform_edt

    if not solid.any():
        return None
    if solid.all():
        return float((np.array(solid.shape) * spacing).min())
    # the block is continued beyond its border
    inner = distance_transform_edt(np.pad(solid, 1, mode="edge"), sampling=spacing)[1:-1, 1:-1, 1:-1]
    half = float(spacing.max()) / 2.0
    low, high = half, float(inner.max())
    while high - low > half / 4.0:
        radius = (low + high) / 2.0
        centres = inner >= radius
        reached = distance_transform_edt(~centres, sampling=spacing) <= _CORNER * radius + half
        missed = (solid & ~reached).sum() / solid.sum()
        low, high = (radius, high) if missed <= _THIN_FRACTION else (low, radius)
    # a voxel that is k voxels from the nearest void is in a wall of 2 k - 1 or 2 k voxels
    return max(2.0 * low - half / 2.0, 0.0)


def _escape_diameter(void: Bools, spacing: Floats) -> tuple[float | None, float]:
    """Find the diameter by bisection: most of the void in the middle must be reached by a ball that escapes."""
    from scipy.ndimage import distance_transform_edt

    open_ = _reaching_sides(void)
    pocket = float((void & ~open_).sum()) / void.size
    if not open_.any():
        return (0.0 if void.any() else None), pocket
    # the space beside the block is free; the plate and the part close it below and above
    padded = np.pad(np.pad(void, ((1, 1), (1, 1), (0, 0)), constant_values=True), ((0, 0), (0, 0), (1, 1)))
    clear = distance_transform_edt(padded, sampling=spacing)[1:-1, 1:-1, 1:-1]
    middle = _middle(void)
    deepest = void & middle
    half = float(spacing.max()) / 2.0
    low, high = 0.0, float(clear.max()) + half
    while high - low > half / 4.0:
        radius = (low + high) / 2.0
        free = clear >= radius
        leaves = _reaching_sides(free)
        # powder escapes from a place if a ball that escapes reaches the place
        reached = (
            distance_transform_edt(~leaves, sampling=spacing) <= radius + 2.0 * half
            if leaves.any()
            else leaves
        )
        trapped = (deepest & ~reached).sum() / max(int(deepest.sum()), 1)
        low, high = (radius, high) if trapped <= _TRAPPED_FRACTION else (low, radius)
    return max(2.0 * low - half / 2.0, 0.0), pocket


def _reaching_sides(free: Bools) -> Bools:
    """Tell which voxels are connected to a vertical side of the block."""
    from scipy.ndimage import label

    numbers, _ = label(free)
    rim = np.concatenate(
        [numbers[0].ravel(), numbers[-1].ravel(), numbers[:, 0].ravel(), numbers[:, -1].ravel()]
    )
    found = np.unique(rim[rim > 0])
    return np.asarray(np.isin(numbers, found))


def _middle(void: Bools) -> Bools:
    """Mark the inner third of the block in plan, from which the escape channels are longest."""
    marked = np.zeros_like(void)
    x, y = (n // 3 for n in void.shape[:2])
    marked[x : 2 * x, y : 2 * y] = True
    return marked
