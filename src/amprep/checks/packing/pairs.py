"""Distances of the pairs of placed bodies that are too close, by two independent methods, and how many each judged."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.meshes.box_tree import BoxTree
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.distance import thickness, tree_distance
from amprep.model.control import Stop
from amprep.model.counting import counted

if TYPE_CHECKING:
    from manifold3d import Manifold

    from amprep.kernels.meshes.distance import PlacedTree

# Strategy. Pairs whose boxes are far apart are no concern. Of the others the distance of the triangles is found on
# trees, but no farther than the distance that is needed. Surfaces that do not meet are apart, or one body contains a
# whole component of the surface of the other: then it contains a vertex of that component. Surfaces that meet may
# touch or overlap; how deep they overlap is measured on the intersection of the solids, which manifold3d computes.
# So only pairs in contact, and wrong ones, cost an intersection.

MEETING = 1e-6
"""Distance (mm) up to which surfaces are judged by the intersection of their solids."""


@dataclass(frozen=True, eq=False)
class PlacedBody:
    """A closed mesh, or a surface, in the coordinates of a build.

    Attributes
    ----------
    vertices
        ``(n, 3)`` mm.
    make_tree
        Makes the tree of its triangles, or returns the one made before, which copies share.
    solid
        Makes the body as a solid, or returns the one made before; None for a surface.
    """

    vertices: Floats
    make_tree: Callable[[], BoxTree]
    solid: "Callable[[], Manifold] | None"

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """Least and greatest corner, each ``(3,)`` mm."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @cached_property
    def tree(self) -> BoxTree:
        """The tree of its triangles."""
        return self.make_tree()

    @cached_property
    def placed(self) -> "PlacedTree":
        """The tree with the boxes of this placement."""
        return self.tree.placed(self.vertices)


@dataclass(frozen=True)
class PairCounts:
    """Numbers of pairs by the method that judged them.

    Attributes
    ----------
    boxes
        The enclosing boxes are far enough apart.
    triangles
        The distance of the triangles was computed.
    solids
        The solids were also intersected, because the surfaces meet or one is inside the other.
    """

    boxes: int = 0
    triangles: int = 0
    solids: int = 0

    def __add__(self, other: "PairCounts") -> "PairCounts":
        """Return the numbers of both together."""
        return PairCounts(
            self.boxes + other.boxes, self.triangles + other.triangles, self.solids + other.solids
        )

    @property
    def total(self) -> int:
        """Number of pairs."""
        return self.boxes + self.triangles + self.solids

    def __str__(self) -> str:
        """Return the methods that judged any pairs, for example ``2 pairs by their enclosing boxes, 1 by ...``."""
        methods = ("enclosing boxes", self.boxes), ("triangles", self.triangles), ("solids", self.solids)
        first, *others = [method for method in methods if method[1]] or methods[:1]
        words = [f"{counted(first[1], 'pair')} by their {first[0]}"]
        return ", ".join(words + [f"{count} by their {name}" for name, count in others])


class CloseBodies(NamedTuple):
    """A pair of bodies i < j that are too close; `gap` (mm) is negative if they overlap, 0 if they touch."""

    i: int
    j: int
    gap: float


class PairJudgement(NamedTuple):
    """The pairs that are too close, how the pairs were judged, and how many were left when the judge was stopped."""

    close: list[CloseBodies]
    counts: PairCounts
    left: int


def judge_pairs(
    bodies: Sequence[PlacedBody],
    pairs: Sequence[tuple[int, int]],
    needed: Floats,
    tolerance: float,
    stop: Stop,
) -> PairJudgement:
    """Judge pairs of bodies whose boxes are near.

    Parameters
    ----------
    bodies
        The bodies of one build.
    pairs
        Pairs i < j.
    needed
        Least distance of each pair, mm.
    tolerance
        mm; a distance may be smaller by this much, and an overlap up to it is contact.
    stop
        Asked before each pair.
    """
    gaps: list[float] = []
    for (i, j), least in zip(pairs, needed, strict=True):
        if stop():
            break
        gaps.append(_surface_gap(bodies[i], bodies[j], float(least), tolerance))
    judged = pairs[: len(gaps)]
    nested = _nested(bodies, [pair for pair, gap in zip(judged, gaps, strict=True) if gap > MEETING])
    close, solids = [], 0
    for pair, gap, least in zip(judged, gaps, needed, strict=False):
        one, other = (bodies[k] for k in pair)
        if (gap <= MEETING or pair in nested) and one.solid and other.solid:
            gap, solids = -thickness(one.solid() ^ other.solid()), solids + 1  # noqa: PLW2901
        if gap < least - tolerance:
            close.append(CloseBodies(*pair, gap))
    return PairJudgement(close, PairCounts(0, len(judged) - solids, solids), len(pairs) - len(judged))


def _surface_gap(one: PlacedBody, other: PlacedBody, needed: float, tolerance: float) -> float:
    """Return the distance of two surfaces, or the needed one if that is kept.

    Of solids it is exact above `MEETING`; of other surfaces that intersect it is minus the depth.
    """
    if one.solid is None or other.solid is None:
        return tree_distance(one.placed, other.placed, max(needed, 0.0), -np.inf)
    limit = max(needed - tolerance, MEETING)
    gap = tree_distance(one.placed, other.placed, limit, 0.5 * MEETING)
    return gap if gap < limit else max(needed, 2.0 * MEETING)


def _nested(bodies: Sequence[PlacedBody], pairs: Sequence[tuple[int, int]]) -> set[tuple[int, int]]:
    """Return the pairs of solids of which one contains a component of the surface of the other."""
    found: set[tuple[int, int]] = set()
    for host, guests in _guests(bodies, pairs):
        points = [bodies[guest].vertices[bodies[guest].tree.shell_vertices] for guest in guests]
        owner = np.repeat(guests, [len(each) for each in points])
        body = bodies[host]
        within = inside(np.concatenate(points), body.vertices, body.tree.triangles.astype(np.int32))
        found |= {(min(host, int(guest)), max(host, int(guest))) for guest in owner[within]}
    return found


def _guests(
    bodies: Sequence[PlacedBody], pairs: Sequence[tuple[int, int]]
) -> Iterator[tuple[int, list[int]]]:
    """Yield each solid with the solids of which a component may be inside it, because a vertex is in its box."""
    guests: dict[int, list[int]] = {}
    for i, j in pairs:
        if bodies[i].solid is None or bodies[j].solid is None:
            continue
        for host, guest in ((i, j), (j, i)):
            lo, hi = bodies[host].bounds
            least, most = bodies[guest].bounds
            if ((least < hi) & (most > lo)).all():
                points = bodies[guest].vertices[bodies[guest].tree.shell_vertices]
                if ((points > lo) & (points < hi)).all(axis=1).any():
                    guests.setdefault(host, []).append(guest)
    yield from guests.items()
