"""Join the cells of support sections: where they overlap as patterns, each made once, and then all by welding."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.geometry.cell_edges import separate_edges
from amprep.geometry.cell_meetings import find_meetings, find_overlaps
from amprep.geometry.cell_patterns import Pattern, find_patterns, unite
from amprep.geometry.cell_tiling import Arrays, expand
from amprep.geometry.merging import compact
from amprep.geometry.welding import cancel_opposite, merge_vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST_ROUNDS = 12


class Sections(NamedTuple):
    """Cells that replace support sections, one each.

    Attributes
    ----------
    template
        ``(n,)`` int64.
    square
        ``(n, 3)`` int64 (x, y, layer): the section's upper square, and the layer it lies in.
    shift
        ``(n, 2)`` int64 (dx, dy) from the upper to the lower square, each -1, 0 or 1.
    kind
        ``(n,)`` int64, 0 for cells, 1 for what stands in the same place as a cell.
    """

    template: Ints
    square: Ints
    shift: Ints
    kind: Ints


class Grid(NamedTuple):
    """Where the grid lies: origin ``(3,)`` and size ``(3,)`` of its cubes, mm."""

    origin: Floats
    size: Floats


def join_sections(templates: Sequence[Arrays], sections: Sections, grid: Grid) -> Arrays:
    """Return the union of the cells as one closed mesh.

    Sections whose prisms overlap form clusters; a cluster is united by manifold3d, equal ones only once.
    Clusters touch in flat faces, and where both have the same triangles there, these cancel. Clusters that
    meet otherwise become one, until none do.

    Parameters
    ----------
    templates
        Closed meshes in the unit cube.

    Returns
    -------
    points, triangles
        mm, as a build file keeps them.
    """
    cluster = connected(len(sections.template), find_overlaps(sections.square, sections.shift, sections.kind))
    known: dict[Pattern, Arrays] = {}
    for tries in range(MOST_ROUNDS):
        patterns, pattern, corner = find_patterns(*sections, cluster)
        for each in patterns:
            if each not in known:
                known[each] = unite(templates, each)
        matrix = np.zeros((len(pattern), 3, 4))
        matrix[:, [0, 1, 2], [0, 1, 2]] = grid.size
        matrix[:, :, 3] = grid.origin + corner * grid.size
        points, triangles, source = expand([known[each] for each in patterns], pattern, matrix)
        merged, corners = merge_vertices(points, triangles)
        stays = cancel_opposite(corners)
        meetings = find_meetings((points[triangles[stays]] - grid.origin) / grid.size, source[stays])
        if len(meetings) == 0:
            break
        joined = connected(len(pattern), meetings) if tries + 2 < MOST_ROUNDS else np.zeros(len(pattern), np.int64)
        cluster = joined[cluster]
    return separate_edges(*compact(merged, corners[stays]))


def connected(count: int, pairs: Ints) -> Ints:
    """Number the connected components of `count` things, ``(count,)``, joined in `pairs` ``(k, 2)``."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)
