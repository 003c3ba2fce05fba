"""Leave out connectors that are too narrow, and the supports that would end below them."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.geometry.connectors.least_width import LeastSection, Posts, find_posts, find_wide
from amprep.geometry.connectors.tips import grid_prisms
from amprep.model.supports import CONNECTOR_BLOCKED
from amprep.model.supports.edges import square_keys
from amprep.supports.layout import SupportLayout
from amprep.supports.legs.leave_out import leads_to
from amprep.supports.solids.connectors import ColumnSurfaces

if TYPE_CHECKING:
    from manifold3d import Manifold


def without_narrow(
    layout: SupportLayout,
    surfaces: ColumnSurfaces,
    least: LeastSection,
    known: dict[bytes, Bools] | None = None,
) -> tuple[SupportLayout, ColumnSurfaces, Posts]:
    """Return a layout and its surfaces without the columns in which connectors would be narrower than a least section.

    Surfaces that are narrow everywhere are held by posts. Edges and feet that lead only to columns without a connector
    are left out.

    Parameters
    ----------
    layout
        Routed supports of the build.
    surfaces
        Surfaces of the parts in the columns above red squares.
    least
        Least section of connectors.
    known
        Answers of `find_wide` for columns of the same grid and rules.
    """
    wide = find_wide(surfaces.supported, surfaces.columns, least, known)
    posts = find_posts(surfaces.supported, wide, surfaces.columns, least)
    held = np.zeros(len(layout.connected), np.bool_)
    held[surfaces.supported.owner[wide, 0]] = True
    held[posts.column] = True
    kept = surfaces._replace(supported=surfaces.supported.chosen(wide))
    return without_columns(layout, layout.connected & ~held), kept, posts


def without_columns(layout: SupportLayout, lost: Bools) -> SupportLayout:
    """Return a layout in which the red squares `lost` ``(m,)`` are unconnected, without edges to them alone.

    Where a strut leads from a support that stays up to one that would go, that one stays below the strut.
    """
    if not lost.any():
        return layout
    connected = layout.connected & ~lost
    ends = square_keys(layout.red.square[connected])
    used = leads_to(layout.edges, ends)
    braces = _braces(layout, used)
    used = leads_to(layout.edges, np.concatenate([ends, braces]))
    edges = layout.edges[used]
    stood_on = np.concatenate([square_keys(edges.lower), ends])
    reasons = tuple(
        CONNECTOR_BLOCKED if gone else why for gone, why in zip(lost.tolist(), layout.reasons, strict=True)
    )
    return replace(
        layout,
        connected=connected,
        reasons=reasons,
        edges=edges,
        red_group=np.where(connected, layout.red_group, -1),
        feet=layout.feet[np.isin(square_keys(layout.feet[:, :3]), stood_on)],
    )


def _braces(layout: SupportLayout, used: Bools) -> Int64s:
    """Return the squares from which unused edges lead down two ways, one of them a strut to edges in use."""
    upper, lower = square_keys(layout.edges.upper), square_keys(layout.edges.lower)
    in_use = np.unique(np.concatenate([upper[used], lower[used]]))
    unused = np.flatnonzero(~used)
    square, count = np.unique(upper[unused], return_counts=True)
    forks = square[count > 1]
    leads_down = in_use[in_use >= square_keys(np.array([[1, 0, 0]], np.int32))[0]]
    for plane in np.unique(
        layout.edges.plane[unused]
    ):  # from below, over the struts that lead to edges in use
        own = unused[layout.edges.plane[unused] == plane]
        leads_down = np.append(leads_down, upper[own[np.isin(lower[own], leads_down)]])
    return np.asarray(forks[np.isin(forks, leads_down)])


def post_solids(
    posts: Posts, surfaces: ColumnSurfaces, chosen: Bools, base: np.ndarray, overlap: float
) -> "Manifold":
    """Return the posts in the chosen columns ``(m,)``, from their base ``(m,)`` mm up into the part by the overlap."""
    own = chosen[posts.column]
    column = posts.column[own]
    square = surfaces.columns.square[column]
    return grid_prisms(square, posts.lo[own], posts.hi[own], base[column], posts.top[own] + overlap)
