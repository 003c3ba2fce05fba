"""Measures a block of cells on voxels: how thin it gets, and how large a ball gets out of it."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.meshes.containment import inside

_SHARE_THIN = 0.01
"""Of the cell's volume: so much may be thinner than its smallest feature."""

_SHARE_LEFT = 0.05
"""Of the powder: so much may stay in corners that the ball does not reach."""

_CORNER = 1.75
"""A ball in the corner of a cube leaves points up to the root of three times its radius from its centre."""


def feature(
    meshes: Sequence[MeshArrays], template: Int64s, place: Int64s, size: Floats, steps: int
) -> float | None:
    """Return the smallest feature of a block, mm, to within a voxel; None when it is empty.

    Parameters
    ----------
    meshes
        Closed meshes in the unit cube.
    template, place
        ``(n,)`` which mesh, and ``(n, 3)`` in which cube of a block (x, y, layer), from 0.
    size
        ``(3,)`` mm of a cube.
    steps
        Voxels along each side of a cube.
    """
    return _thinnest(_block(meshes, template, place, steps), size / steps)


def way_out(
    meshes: Sequence[MeshArrays], template: Int64s, place: Int64s, size: Floats, steps: int
) -> tuple[float | None, float]:
    """Return the diameter of the largest ball that gets out sideways from most of the void, mm, and closed pockets.

    The plate lies below, the part above: the ways out are the four sides. Pockets are a share of the block's
    volume; without any void there is no ball. The parameters are those of `feature`.
    """
    return _way_out(~_block(meshes, template, place, steps), size / steps)


def _block(meshes: Sequence[MeshArrays], template: Int64s, place: Int64s, steps: int) -> Bools:
    """Tell which voxels of the block are solid."""
    cubes = [_voxels(mesh, steps) for mesh in meshes]
    extent = place.max(axis=0) + 1
    block = np.zeros(tuple((extent * steps).tolist()), np.bool_)
    for index, (x, y, z) in zip(template.tolist(), (place * steps).tolist(), strict=True):
        block[x : x + steps, y : y + steps, z : z + steps] |= cubes[index]
    return block


def _voxels(mesh: MeshArrays, steps: int) -> Bools:
    """Tell which voxels have their centre in the mesh."""
    middles = (np.arange(steps) + 0.5) / steps
    centres = np.stack(np.meshgrid(middles, middles, middles, indexing="ij"), axis=-1).reshape(-1, 3)
    # off the symmetry planes, in which vertices tend to lie
    points, triangles = mesh
    found = inside(centres + 1e-7 * np.array([1.0, 1.7, 2.3]), points, triangles.astype(np.int32))
    return found.reshape(steps, steps, steps)


def _thinnest(solid: Bools, spacing: Floats) -> float | None:
    """Return the largest diameter of a ball that, rolled inside, leaves nothing out but corners."""
    from scipy.ndimage import distance_transform_edt

    if not solid.any():
        return None
    if solid.all():
        return float((np.array(solid.shape) * spacing).min())
    # beyond the block the cell goes on as at its border
    inner = distance_transform_edt(np.pad(solid, 1, mode="edge"), sampling=spacing)[1:-1, 1:-1, 1:-1]
    half = float(spacing.max()) / 2.0
    low, high = half, float(inner.max())
    while high - low > half / 4.0:
        radius = (low + high) / 2.0
        centres = inner >= radius
        reached = distance_transform_edt(~centres, sampling=spacing) <= _CORNER * radius + half
        missed = (solid & ~reached).sum() / solid.sum()
        low, high = (radius, high) if missed <= _SHARE_THIN else (low, radius)
    return max(2.0 * low - half / 2.0, 0.0)  # k voxels from middle to middle: 2 k - 1 or 2 k across


def _way_out(void: Bools, spacing: Floats) -> tuple[float | None, float]:
    """Return what `way_out` does."""
    from scipy.ndimage import distance_transform_edt

    open_ = _reaching_sides(void)
    pocket = float((void & ~open_).sum()) / void.size
    if not open_.any():
        return (0.0 if void.any() else None), pocket
    # outside the sides the ball is free; below and above there is something
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
        # powder of a place can leave when a ball that gets out reaches it
        reached = (
            distance_transform_edt(~leaves, sampling=spacing) <= radius + 2.0 * half
            if leaves.any()
            else leaves
        )
        stays = (deepest & ~reached).sum() / max(int(deepest.sum()), 1)
        low, high = (radius, high) if stays <= _SHARE_LEFT else (low, radius)
    return max(2.0 * low - half / 2.0, 0.0), pocket


def _reaching_sides(free: Bools) -> Bools:
    from scipy.ndimage import label

    numbers, _ = label(free)
    rim = np.concatenate(
        [numbers[0].ravel(), numbers[-1].ravel(), numbers[:, 0].ravel(), numbers[:, -1].ravel()]
    )
    found = np.unique(rim[rim > 0])
    return np.asarray(np.isin(numbers, found))


def _middle(void: Bools) -> Bools:
    """Mark the inner third of the block in plan: what lies there has the longest way."""
    marked = np.zeros_like(void)
    x, y = (n // 3 for n in void.shape[:2])
    marked[x : 2 * x, y : 2 * y] = True
    return marked
