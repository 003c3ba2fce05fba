"""Group overhangs into connected regions."""

from typing import Literal, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int32s, Int64s
from amprep.geometry.overhangs.surface import Surface

Kind = Literal["face", "ledge", "bridge", "bore", "flat", "edge", "tip"]
"""Kinds of overhangs. Faces are ledges, bridges, bores or flats where limits apply, else ``face``."""

NOT_FACES = ("edge", "tip")
"""Kinds of overhangs that are no faces."""

Feature = Literal["face", "edge", "tip"]
"""Features of a mesh that overhangs consist of."""


class OverhangRegion(NamedTuple):
    """A connected region of overhangs.

    Attributes
    ----------
    kind
        ``edge``, ``tip``, or a kind of faces: ``ledge`` (carried on one side), ``bridge`` (on two sides), ``bore`` (an
        arch), ``flat`` (on no side), or ``face`` where the angle alone counts.
    measure
        Area in mm2, length in mm, or 0 for a tip: of what needs support in the region, if anything does.
    centre
        ``(3,)`` mm, weighted by area or length.
    size_mm
        Length of a ledge, span of a bridge, or diameter of a bore that is the largest of the region, mm; of an edge
        that is carried at its ends its length or span; 0 where nothing carries the region.
    limit_mm
        Limit of that size.
    starts_in_air
        Whether the part starts in the air in the region.
    is_self_supporting
        Whether the part itself carries all of the region.
    angle_deg
        Smallest angle of its faces to the plate.
    lowest_mm
        Height of its lowest point.
    is_noncritical
        Whether its faces are between the overhang angle and the noncritical angle.
    """

    kind: Kind
    measure: float
    centre: Floats
    size_mm: float = 0.0
    limit_mm: float = 0.0
    starts_in_air: bool = False
    is_self_supporting: bool = False
    angle_deg: float = 0.0
    lowest_mm: float = 0.0
    is_noncritical: bool = False

    @property
    def feature(self) -> Feature:
        """What the region consists of: faces, knife edges, or a tip."""
        return "edge" if self.kind == "edge" else "tip" if self.kind == "tip" else "face"


class Overhangs(NamedTuple):
    """All overhangs of a mesh, in connected regions.

    Faces, edges and tips are those that need support. Regions that the part itself carries are in `regions`, too.

    Attributes
    ----------
    faces
        ``(f,)`` int32, triangles.
    face_region
        ``(f,)`` int32, index into `regions`, in which regions of faces come first, then edges, then tips.
    edges
        ``(e, 2)`` int32, vertex indices.
    edge_region
        ``(e,)`` int32.
    tips
        ``(t,)`` int32, vertex indices.
    tip_region
        ``(t,)`` int32.
    beside
        ``(b,)`` int32, other triangles of regions that need support; contacts may extend to them.
    """

    faces: Int32s
    face_region: Int32s
    edges: Int32s
    edge_region: Int32s
    tips: Int32s
    tip_region: Int32s
    regions: tuple[OverhangRegion, ...]
    beside: Int32s = np.empty(0, np.int32)


def connected_components(start: Int64s, end: Int64s, count: int) -> Int64s:
    """Label the connected components of a graph of `count` nodes with edges `start`-`end`."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(start), np.int8), (start, end)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def components_of_faces(surface: Surface, overhanging: Bools) -> Int64s:
    """Label the overhanging faces; faces that share an edge have the same label."""
    position = np.cumsum(overhanging) - 1
    halves = np.flatnonzero(overhanging[surface.half_face])
    same = surface.half_edge[halves[1:]] == surface.half_edge[halves[:-1]]
    faces = position[surface.half_face[halves]]
    return connected_components(faces[:-1][same], faces[1:][same], int(overhanging.sum()))


def components_of_edges(edges: Int64s, count: int) -> Int64s:
    """Label edges ``(e, 2)`` among `count` points; edges that share a point have the same label."""
    return connected_components(edges[:, 0], edges[:, 1], count)[edges[:, 0]]


def large_enough(label: Int64s, measure: Floats, smallest: float, always: Bools) -> Bools:
    """Tell which members belong to regions that are large enough or contain a member to keep always.

    Parameters
    ----------
    label
        ``(n,)`` region of each member.
    measure
        ``(n,)`` area or length of each member.
    smallest
        Smallest area or length of a region to keep.
    always
        ``(n,)`` bool, members whose region is kept whatever its size.
    """
    keep = np.bincount(label, weights=measure) >= smallest
    keep[label[always]] = True
    return np.asarray(keep[label])


def labelled_regions(
    surface: Surface,
    faces: tuple[Int64s, Int64s, Floats],
    edges: tuple[Int64s, Int64s, Floats],
    tips: tuple[Int64s, Int64s],
) -> Overhangs:
    """Number the regions 0, 1, ..., faces first, and measure them.

    Parameters
    ----------
    surface
        The merged surface.
    faces, edges
        Indices of faces (points of edges), their labels, and their areas (lengths).
    tips
        Points, and their labels.
    """
    points = surface.points
    groups: list[Int32s] = []
    regions: list[OverhangRegion] = []
    middle = points[surface.triangles[faces[0]]].mean(axis=1).reshape(-1, 3)
    halfway = points[edges[0]].mean(axis=1).reshape(-1, 3)
    kinds: tuple[tuple[Kind, Int64s, Floats, Floats], ...] = (
        ("face", faces[1], faces[2], middle),
        ("edge", edges[1], edges[2], halfway),
        ("tip", tips[1], np.ones(len(tips[1])), points[tips[0]]),
    )
    for kind, label, weight, centres in kinds:
        number = numbered_by_first(label)
        groups.append((number + len(regions)).astype(np.int32))
        total = np.bincount(number, weights=weight)
        centre = [np.bincount(number, weights=weight * centres[:, i]) / total for i in range(3)]
        for i in range(len(total)):
            measure = 0.0 if kind == "tip" else float(total[i])
            regions.append(OverhangRegion(kind, measure, np.array([c[i] for c in centre])))
    first = surface.first.astype(np.int32)
    return Overhangs(
        faces[0].astype(np.int32),
        groups[0],
        first[edges[0]],
        groups[1],
        first[tips[0]],
        groups[2],
        tuple(regions),
    )


def numbered_by_first(label: Int64s) -> Int64s:
    """Return labels as 0, 1, ... in the order of their first appearance."""
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[inverse]
