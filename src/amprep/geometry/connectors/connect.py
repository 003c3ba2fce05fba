"""Build the closed meshes of connectors below the overhangs in their columns."""

from itertools import count

import numpy as np

from amprep.arrays import Bools, Floats, Int64s, MeshArrays
from amprep.geometry.connectors.prisms import prisms_below, solids_between
from amprep.geometry.merging.nonmanifold_edges import split_nonmanifold_edges
from amprep.geometry.merging.union import arrays_of, union
from amprep.geometry.meshes.welding import label_equal_rows, round_as_stored
from amprep.kernels.meshes import patches as kernels
from amprep.kernels.meshes.patches import Patches, RaisedPatches

MAX_PATCHES_UNCULLED = 64
"""In columns with more obstructing patches than this, hidden patches are culled first."""

_SAMPLES = 64
"""Sample points along each side of a column; a patch visible from below only between them counts as hidden."""

# Strategy. A connector fills its column from the base up to the lowest face that points down, if that face is
# supported, and enters it by the overlap.
# 1. Columns in which no other face is below a supported one (nearly all of them) need no Boolean: the prisms below
#    the patches are one closed mesh per connected surface (`prisms_below`). Surfaces that only touch in plan stay
#    apart, because manifold3d simplifies badly where walls of two prisms coincide. Surfaces that are not in
#    neighbouring squares go into one mesh (`_colour_surfaces`), so that there are few meshes to read and unite.
# 2. In the other columns manifold3d subtracts the space above the obstructing patches from the space below the
#    supported ones. The top of that space is higher than every connector.
# 3. A column with very many patches, above a finely tessellated part, would take that Boolean too long; patches that
#    are not visible from below change nothing and are culled first.


def find_covered(supported: Patches, surface: Patches) -> Bools:
    """Tell in which columns another face of the parts is below a supported one, ``(m,)``."""
    covered = np.zeros(len(supported.of_column) - 1, np.bool_)
    covered[surface.owner[find_below(supported, surface), 0]] = True
    return covered


def find_below(supported: Patches, surface: Patches) -> Bools:
    """Tell which patches of `surface` are, at least in part, below another patch that is supported, ``(n,)``."""
    below = np.zeros(len(surface.owner), np.bool_)
    kernels.find_below(supported, surface, below)
    return below


def connect(
    supported: Patches,
    surface: Patches,
    *,
    square: Int64s,
    base: Floats,
    top: Floats,
    overlap: float,
    own: Bools,
) -> list[MeshArrays]:
    """Fill columns from their base up to the supported faces; where another face is below one, up to that face.

    Parameters
    ----------
    supported
        Overhangs in the columns.
    surface
        All faces of all parts in the columns that point down, supported or not.
    square
        ``(m, 2)`` indices y, x of the square of each column.
    base, top
        ``(m,)`` mm, height at which the connector of each column begins, and a height above all connectors.
    overlap
        Depth (mm) to which connectors enter the supported part, more than `RUN_SLACK`.
    own
        ``(n,)`` whether each patch of `surface` belongs to the part that its column supports. Connectors stop
        `overlap` below faces of other parts.

    Returns
    -------
    meshes
        Closed meshes that may touch: a few over all unobstructed columns, and one per obstructed column.
    """
    rise = np.where(own, overlap, -overlap)
    supported, below = _cull_hidden(supported, surface, find_below(supported, surface), overlap, rise)
    obstructing, rise = surface.chosen(below), rise[below]
    covered = np.diff(obstructing.of_column) > 0
    free = supported.chosen(~covered[supported.owner[:, 0]])
    meshes = []
    colour = _colour_surfaces(label_surfaces(free), free.owner[:, 0], square)
    for each in range(int(colour.max(initial=-1)) + 1):
        apart = free.chosen(colour == each)
        meshes.append(split_nonmanifold_edges(*prisms_below(apart, base[apart.owner[:, 0]], overlap)))
    for column in np.flatnonzero(covered).tolist():
        space = union(list(solids_between(*supported.in_column(column), overlap, base[column])))
        first, last = obstructing.of_column[column : column + 2]
        space -= union(
            list(
                solids_between(*obstructing.in_column(column), rise[first:last], top[column], from_above=True)
            )
        )
        if not space.is_empty():
            meshes.append(arrays_of(space))
    return meshes


def label_surfaces(patches: Patches, kind: Int64s | None = None) -> Int64s:
    """Number the connected surfaces of patches that share whole edges, and have one kind ``(n,)``, if given."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(patches.owner)
    corner, _ = label_equal_rows(round_as_stored(patches.points).view(np.int64))
    of_patch = np.zeros(count, np.int64) if kind is None else kind
    patch = np.repeat(np.arange(count), np.diff(patches.start))
    here = np.arange(len(corner))
    after = np.where(here + 1 == patches.start[1:][patch], patches.start[:-1][patch], here + 1)
    ends = np.sort(np.column_stack([corner, corner[after]]), axis=1)
    edge, edges = label_equal_rows(np.column_stack([ends, of_patch[patch]]))
    graph = coo_array((np.ones(len(edge), np.int8), (patch, count + edge)), shape=(count + edges,) * 2)
    label = connected_components(graph, directed=False)[1][:count]
    return np.asarray(np.unique(label, return_inverse=True)[1], np.int64)


def _colour_surfaces(surface: Int64s, column: Int64s, square: Int64s) -> Int64s:
    """Colour surfaces so that no two with one colour are in one square or in neighbouring ones.

    Parameters
    ----------
    surface, column
        ``(n,)`` surface and column of each patch.
    square
        ``(m, 2)`` indices y, x of the square of each column.

    Returns
    -------
    colour
        ``(n,)`` colour of each patch: the first that is free for its surface.
    """
    wide = int(square[:, 1].max(initial=0)) + 3
    place = square[column] @ np.array([wide, 1])
    around = (np.arange(-1, 2)[:, None] * wide + np.arange(-1, 2)).ravel().tolist()
    taken: dict[int, set[int]] = {}
    colour = np.zeros(int(surface.max(initial=-1)) + 1, np.int64)
    squares: list[set[int]] = [set() for _ in colour]
    for each, at in zip(surface.tolist(), place.tolist(), strict=True):
        squares[each].add(at)
    for each, own in enumerate(squares):
        used: set[int] = set().union(*(taken.get(at + step, ()) for at in own for step in around))
        free = next(number for number in count() if number not in used)
        colour[each] = free
        for at in own:
            taken.setdefault(at, set()).add(free)
    return np.asarray(colour[surface])


def _cull_hidden(
    supported: Patches, surface: Patches, below: Bools, overlap: float, rise: Floats
) -> tuple[Patches, Bools]:
    """In columns with many obstructing patches, remove the patches that lower ones hide.

    Returns
    -------
    supported, below
        Supported patches that remain, and which patches of `surface` remain obstructing.
    """
    keep, below = np.ones(len(supported.owner), np.bool_), below.copy()
    many = np.bincount(surface.owner[below, 0], minlength=len(supported.of_column) - 1) > MAX_PATCHES_UNCULLED
    for column in np.flatnonzero(many).tolist():
        ours, theirs = (slice(*each.of_column[column : column + 2]) for each in (supported, surface))
        around = RaisedPatches(*surface.in_column(column), rise[theirs])
        raised = RaisedPatches(*supported.in_column(column), np.full(ours.stop - ours.start, overlap))
        spacing = float(np.ptp(around.points[:, :2], axis=0).max()) / _SAMPLES
        kernels.find_visible(raised, around, spacing, keep[ours])
        visible = np.zeros(theirs.stop - theirs.start, np.bool_)
        kernels.find_visible(around, around, spacing, visible)
        below[theirs] &= visible
    return supported.chosen(keep), below
