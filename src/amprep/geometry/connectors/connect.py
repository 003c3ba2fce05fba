"""Closed meshes of connectors from patches of the parts' surfaces."""

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.connectors.columns import Patches
from amprep.geometry.connectors.prisms import prisms_below, prisms_between
from amprep.geometry.merging.nonmanifold_edges import split_nonmanifold_edges
from amprep.geometry.merging.union import arrays_of, union
from amprep.geometry.meshes.welding import label_equal_rows, round_as_stored
from amprep.kernels.meshes import patches as patch_kernels

MAX_PATCHES_UNCULLED = 64
"""In columns with more patches than this below others, those that are hidden are left out."""

_SAMPLES = 64
"""Points per side of a column's content: a patch seen from below only between them counts as hidden."""


def find_covered(held: Patches, surface: Patches) -> Bools:
    """Tell in which columns something held has another face of the parts below it, ``(m,)``."""
    covered = np.zeros(len(held.of_column) - 1, np.bool_)
    covered[surface.owner[find_below(held, surface), 0]] = True
    return covered


def find_below(held: Patches, surface: Patches) -> Bools:
    """Tell which patches of `surface` lie below, at least in part, another that is held, ``(n,)``."""
    below = np.zeros(len(surface.owner), np.bool_)
    patch_kernels.find_below(
        held.points, held.start, held.owner, held.of_column,
        surface.points, surface.start, surface.owner, surface.of_column, below,
    )  # fmt: skip
    return below


def connect(
    held: Patches, surface: Patches, *, base: Floats, lid: Floats, overlap: float, own: Bools
) -> list[MeshArrays]:
    """Fill columns from the red squares up to the held faces, `overlap` mm into them.

    Where another face lies below a held one it comes first: nothing passes it.

    Parameters
    ----------
    held, surface
        Pieces in the columns; `surface` is all that looks down, of any part, held or not.
    base, lid
        ``(m,)`` mm, where the connectors of each column begin, and a height that none of them reaches.
    overlap
        mm, more than `RUN_SLACK`.
    own
        ``(n,)`` whether each patch of `surface` belongs to the part that its column holds; other parts are
        not touched.

    Returns
    -------
    meshes
        Closed ones that may touch one another: of all columns where nothing is in the way one for each surface
        that hangs together, and one for each other column. Surfaces that only touch in plan stay apart: the
        walls between them lie in each other, and manifold3d joins them without fault, but tidies them badly.
    """
    rise = np.where(own, overlap, -overlap)
    held, below = _cull_hidden(held, surface, find_below(held, surface), overlap, rise)
    cutting, rise = surface.chosen(below), rise[below]
    covered = np.diff(cutting.of_column) > 0
    free = held.chosen(~covered[held.owner[:, 0]])
    meshes = []
    surface_of = _label_surfaces(free)
    for each in range(int(surface_of.max(initial=-1)) + 1):
        whole = free.chosen(surface_of == each)
        meshes.append(split_nonmanifold_edges(*prisms_below(whole, base[whole.owner[:, 0]], overlap)))
    for column in np.flatnonzero(covered).tolist():
        way = union(list(prisms_between(*held.in_column(column), overlap, base[column])))
        first, last = cutting.of_column[column : column + 2]
        way -= union(
            list(prisms_between(*cutting.in_column(column), rise[first:last], lid[column], hang=True))
        )
        if not way.is_empty():
            meshes.append(arrays_of(way))
    return meshes


def _label_surfaces(patches: Patches) -> Int64s:
    """Number the surfaces that patches form where they share whole edges, ``(n,)``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(patches.owner)
    corner, _ = label_equal_rows(round_as_stored(patches.points).view(np.int64))
    patch = np.repeat(np.arange(count), np.diff(patches.start))
    here = np.arange(len(corner))
    after = np.where(here + 1 == patches.start[1:][patch], patches.start[:-1][patch], here + 1)
    ends = np.sort(np.column_stack([corner, corner[after]]), axis=1)
    edge, edges = label_equal_rows(np.column_stack([ends, np.zeros(len(ends), np.int64)]))
    graph = coo_array((np.ones(len(edge), np.int8), (patch, count + edge)), shape=(count + edges,) * 2)
    label = connected_components(graph, directed=False)[1][:count]
    return np.asarray(np.unique(label, return_inverse=True)[1], np.int64)


def _cull_hidden(
    held: Patches, surface: Patches, below: Bools, overlap: float, rise: Floats
) -> tuple[Patches, Bools]:
    """Leave out what is hidden by other patches below it, where a column has many.

    Returns
    -------
    held, below
        What stays of both.
    """
    keep, below = np.ones(len(held.owner), np.bool_), below.copy()
    many = np.bincount(surface.owner[below, 0], minlength=len(held.of_column) - 1) > MAX_PATCHES_UNCULLED
    for column in np.flatnonzero(many).tolist():
        ours, theirs = (slice(*each.of_column[column : column + 2]) for each in (held, surface))
        around = *surface.in_column(column), rise[theirs]
        lift = np.full(ours.stop - ours.start, overlap)
        spacing = float(np.ptp(around[0][:, :2], axis=0).max()) / _SAMPLES
        patch_kernels.find_visible(*held.in_column(column), lift, *around, spacing, keep[ours])
        seen = np.zeros(theirs.stop - theirs.start, np.bool_)
        patch_kernels.find_visible(*around, *around, spacing, seen)
        below[theirs] &= seen
    return held.chosen(keep), below
