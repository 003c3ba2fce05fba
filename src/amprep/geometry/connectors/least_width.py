"""Find the surfaces in columns that are wide enough for connectors, and the posts that hold those that are not."""

import hashlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.connectors.columns import ConnectorColumns
from amprep.geometry.connectors.connect import label_surfaces
from amprep.geometry.connectors.sites import areas_in_plan, fans_of, find_sites, squares_in_cells
from amprep.geometry.supports.footprints import box
from amprep.kernels.meshes.patches import Patches

if TYPE_CHECKING:
    from manifold3d import CrossSection

_SEAM = 1e-3
"""Width (mm) of seams between neighbouring patches that are closed before widths are measured."""

_MARGIN = 0.03
"""Length (mm) by which posts are wider than the least width: rounding and faces beside them take a little away."""

_WHOLE = 1.0 - 1e-6
"""Fraction of a square that counts as all of it."""

# Strategy. The connector below a surface has the surface's outline in plan, so widths are judged in plan, before any
# solid is made.
# 1. Patches that share whole edges, in columns that begin at one height, form one footprint.
# 2. The opening of a footprint (shrunk by half of the least width, and grown back) is where it is wide enough. Columns
#    that have no share in it are left out; if less than the least area remains, so is the whole footprint.
#    A square that is covered entirely is wide: such columns need no test.
# 3. A surface of which nothing remains (a narrow ledge in the air, a strip at a ridge) is held by posts instead.
# The outlines are few and small; the time is that of one offset per footprint.


class LeastSection(NamedTuple):
    """Least width (mm) and least area (mm2) of the footprint of a connector."""

    width: float
    area: float

    @property
    def diameter(self) -> float:
        """Diameter (mm) of the smallest disc that has both."""
        return max(self.width, float(np.sqrt(4.0 / np.pi * self.area)))


class Posts(NamedTuple):
    """Upright posts with square sections.

    Attributes
    ----------
    column
        ``(k,)`` column of each post.
    lo, hi
        ``(k, 2)`` mm, corners of the posts in plan.
    top
        ``(k,)`` mm, lowest height of the surface over each post.
    """

    column: Int64s
    lo: Floats
    hi: Floats
    top: Floats


def find_wide(
    patches: Patches, columns: ConnectorColumns, least: LeastSection, known: dict[bytes, Bools] | None = None
) -> Bools:
    """Tell which patches are, in their column, part of a footprint that is wide enough, ``(n,)``.

    Parameters
    ----------
    patches
        The supported surfaces in the columns.
    columns
        Columns above the red squares; those that begin at one height have a common footprint.
    least
        Least section of a footprint.
    known
        Answers for footprints, which are used and added to; None for none.
    """
    known = {} if known is None else known
    level = np.unique(columns.lo[:, 2], return_inverse=True)[1]
    label = label_surfaces(patches, level[patches.owner[:, 0]])
    order = np.argsort(label, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(label[order])) + 1) if len(order) else []
    area = areas_in_plan(patches)[0]
    wide = np.zeros(len(label), np.bool_)
    for own in groups:
        key = _key_of(patches, own)
        if key not in known:
            known[key] = _is_wide(patches, own, area, columns, least)
        wide[own] = known[key]
    return wide


def _key_of(patches: Patches, own: Int64s) -> bytes:
    """Return a digest of the patches of a footprint and of the columns that they are in."""
    digest = hashlib.sha256(np.ascontiguousarray(patches.owner[own, 0]).tobytes())
    for each in own.tolist():
        digest.update(patches.points[patches.start[each] : patches.start[each + 1]].tobytes() + b",")
    return digest.digest()


def _is_wide(
    patches: Patches, own: Int64s, area: Floats, columns: ConnectorColumns, least: LeastSection
) -> Bools:
    """Tell which patches of one footprint are in columns where it is wide enough; `area` ``(n,)`` mm2 of each patch."""
    column, which = np.unique(patches.owner[own, 0], return_inverse=True)
    side = float(columns.grid[2])
    whole = np.bincount(which, area[own]) >= _WHOLE * side * side
    if area[own].sum() < least.area:
        return np.zeros(len(own), np.bool_)
    if whole.all() and side >= least.width:
        return np.ones(len(own), np.bool_)
    opened = _opening(_outline(patches, own), least.width)
    if opened.area() < least.area:
        return np.zeros(len(own), np.bool_)
    for index in np.flatnonzero(~whole).tolist():
        lo, hi = columns.lo[column[index], :2], columns.hi[column[index], :2]
        whole[index] = (opened ^ box(lo, hi)).area() > 0.25 * least.width**2
    return np.asarray(whole[which])


def _outline(patches: Patches, own: Int64s) -> "CrossSection":
    """Return the union of patches in plan, without seams."""
    from manifold3d import CrossSection, FillRule

    contours = [patches.points[patches.start[each] : patches.start[each + 1], :2] for each in own]
    return CrossSection([np.ascontiguousarray(each) for each in contours], FillRule.NonZero)


def _opening(outline: "CrossSection", width: float) -> "CrossSection":
    """Return the union of all squares of a width, in any direction, that fit into an outline."""
    from manifold3d import JoinType

    half = width / 2.0
    shrunk = outline.offset(_SEAM, JoinType.Miter).offset(-half - _SEAM, JoinType.Miter)
    return shrunk.offset(half, JoinType.Miter)


def find_posts(patches: Patches, wide: Bools, columns: ConnectorColumns, least: LeastSection) -> Posts:
    """Return posts below the surfaces of which no patch is wide enough: one in each column.

    A post is at the middle of the surface in its column, or next to its lowest point. It is moved into the square of
    its column. Where the surface only grazes a column, and has more in another, there is no post.

    Parameters
    ----------
    patches
        The supported surfaces in the columns.
    wide
        ``(n,)`` result of `find_wide`.
    columns, least
        See `find_wide`.
    """
    surface = label_surfaces(patches)
    lost = ~np.isin(surface, surface[wide])
    narrow = patches.chosen(lost)
    size = min(max(least.width, float(np.sqrt(least.area))) + _MARGIN, float(columns.grid[2]))
    sites = find_sites(_triangles(narrow), columns, 1, size)
    share = np.bincount(narrow.owner[:, 0], areas_in_plan(narrow)[0], len(columns.lo))[sites.column]
    most = np.zeros(len(columns.lo))
    np.maximum.at(most, narrow.owner[:, 0], _most(surface[lost], narrow))
    keep = share >= np.minimum(0.25 * least.area, most[sites.column])
    lo, hi = squares_in_cells(sites.spot[keep], size, sites.lo[keep], sites.hi[keep])
    return Posts(sites.column[keep], lo, hi, sites.lowest[keep])


def _most(surface: Int64s, patches: Patches) -> Floats:
    """Return for each patch the largest area that its surface has in one column, ``(n,)`` mm2."""
    pairs = surface * (len(patches.of_column) + 1) + patches.owner[:, 0]
    _, pair = np.unique(pairs, return_inverse=True)
    share = np.bincount(pair, areas_in_plan(patches)[0])[pair] if len(pair) else np.empty(0)
    most = np.zeros(int(surface.max(initial=-1)) + 1)
    np.maximum.at(most, surface, share)
    return np.asarray(most[surface])


def _triangles(patches: Patches) -> Floats:
    """Return patches as triangles ``(t, 3, 3)`` that face down."""
    patch, second, third = fans_of(patches)
    first = patches.points[patches.start[patch]]
    return np.stack([first, patches.points[third], patches.points[second]], axis=1)
