"""Partition a surface into nearly convex patches (thesis 2.5, after Mamou and Ghorbel 2009)."""

import heapq
import math
from collections.abc import Callable

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.bounding.convex.cells import hull_corners, hull_planes

# Strategy. The dual graph has a node for each triangle and an edge where two triangles share an edge. The edge of
# least penalty
#     E = C / D + alpha E_shape,  E_shape = perimeter^2 / (4 pi area),  alpha = epsilon / (10 D)
# is contracted while the concavity C of the united patch is at most epsilon; D is the diagonal of its box. C needs a
# convex hull, which is costly, so it is computed late: C never falls when a patch grows, hence the greater concavity
# of the two patches gives a lower bound of E. A pair waits in the heap with this bound and returns to it with its
# true penalty when it comes to the top. Hulls are incremental: that of a united patch is computed from the corners of
# the two hulls.

DISK = 4.0 * np.pi
"""Squared perimeter of a disk divided by its area."""


class DualGraph:
    """Patches of a mesh, and the lengths of their common borders.

    Attributes
    ----------
    triangles
        Number of the patch -> its triangles (the ancestors A(v) of the thesis).
    border
        Number of the patch -> {number of a neighbour: length of the common border, mm}.
    concavity
        Number of the patch -> its concavity, mm.
    """

    def __init__(self, vertices: Floats, triangles: Int64s) -> None:
        corners = vertices[triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).sum(axis=1)
        count = len(triangles)
        self.vertices, self.mesh = vertices, triangles
        self.triangles = {k: [k] for k in range(count)}
        self.corners = {k: corners[k] for k in range(count)}
        boxes = np.concatenate((corners.min(axis=1), corners.max(axis=1)), axis=1)
        self.box = dict(enumerate(boxes.tolist()))
        self.area = dict(enumerate((np.linalg.norm(normal, axis=1) / 2).tolist()))
        self.perimeter = dict(enumerate(sides.tolist()))
        self.concavity = dict.fromkeys(range(count), 0.0)
        self.least: list[dict[int, float]] = [{} for _ in range(count)]
        self.border: dict[int, dict[int, float]] = {k: {} for k in range(count)}
        self._connect()

    def _connect(self) -> None:
        start, end = self.mesh.ravel(), np.roll(self.mesh, -1, axis=1).ravel()
        face = np.repeat(np.arange(len(self.mesh)), 3)
        low, high = np.minimum(start, end), np.maximum(start, end)
        order = np.lexsort((high, low))
        same = (low[order[1:]] == low[order[:-1]]) & (high[order[1:]] == high[order[:-1]])
        for one, two in zip(order[:-1][same].tolist(), order[1:][same].tolist(), strict=True):
            v, w = int(face[one]), int(face[two])
            length = float(np.linalg.norm(self.vertices[low[one]] - self.vertices[high[one]]))
            if v != w:
                self.border[v][w] = self.border[w][v] = self.border[v].get(w, 0.0) + length

    def diagonal(self, v: int, w: int) -> float:
        """Return the diagonal D of the box of two patches, mm."""
        (ax, ay, az, bx, by, bz), (cx, cy, cz, dx, dy, dz) = self.box[v], self.box[w]
        x, y, z = max(bx, dx) - min(ax, cx), max(by, dy) - min(ay, cy), max(bz, dz) - min(az, cz)
        return math.sqrt(x * x + y * y + z * z)

    def aspect(self, v: int, w: int) -> float:
        """Return E_shape of two patches: 1 for a disk, more for other flat patches, and 0 for a closed surface."""
        perimeter = self.perimeter[v] + self.perimeter[w] - 2.0 * self.border[v][w]
        area = max(self.area[v] + self.area[w], 1e-300)
        return float(max(perimeter, 0.0) ** 2 / (DISK * area))

    def united_concavity(self, v: int, w: int) -> float:
        """Return C of two patches: the greatest distance of their points to the surface of their common hull, mm."""
        planes = hull_planes(np.concatenate((self.corners[v], self.corners[w])))
        if len(planes) == 0:
            return 0.0
        from amprep.kernels.bounding.depth import greatest_depth

        chosen = self.mesh[self.triangles[v] + self.triangles[w]]
        points = np.concatenate((self.vertices[np.unique(chosen)], self.vertices[chosen].mean(axis=1)))
        return float(greatest_depth(points, planes))

    def know(self, v: int, w: int, concavity: float) -> None:
        """Keep a lower bound of C of two patches; it stays valid when they grow."""
        self.least[v][w] = self.least[w][v] = max(concavity, self.least[v].get(w, 0.0))

    def least_concavity(self, v: int, w: int) -> float:
        """Return the greatest lower bound of C of two patches that is known."""
        return max(self.concavity[v], self.concavity[w], self.least[v].get(w, 0.0))

    def contract(self, v: int, w: int, concavity: float) -> None:
        """Unite the patches v and w; the patch v stays."""
        self.triangles[v] += self.triangles.pop(w)
        self.corners[v] = hull_corners(np.concatenate((self.corners[v], self.corners.pop(w))))
        pairs = list(zip(self.box[v], self.box.pop(w), strict=True))
        self.box[v] = [min(pair) for pair in pairs[:3]] + [max(pair) for pair in pairs[3:]]
        self.area[v] += self.area.pop(w)
        self.perimeter[v] += self.perimeter.pop(w) - 2.0 * self.border[v].pop(w)
        self.concavity[v] = max(concavity, self.concavity[v])
        for other, length in self.border.pop(w).items():
            if other != v:
                del self.border[other][w]
                self.know(v, other, self.least_concavity(w, other))
                self.border[v][other] = self.border[other][v] = self.border[v].get(other, 0.0) + length
        del self.concavity[w]


class PairQueue:
    """Pairs of neighbouring patches in the order of their penalties, or of lower bounds of them.

    Attributes
    ----------
    version
        Number of the patch -> number of contractions into it; pairs of earlier versions are skipped.
    """

    def __init__(self, graph: DualGraph, epsilon: float) -> None:
        self.graph, self.epsilon = graph, epsilon
        self.version = dict.fromkeys(graph.border, 0)
        self.heap: list[tuple[float, int, int, int, int, float | None]] = []

    def push(self, v: int, w: int, concavity: float | None = None) -> None:
        """Add a pair with its concavity, or with the lower bound; a pair that is too concave is left out."""
        least = self.graph.least_concavity(v, w) if concavity is None else concavity
        if least <= self.epsilon:
            diagonal = max(self.graph.diagonal(v, w), 1e-300)
            penalty = least / diagonal + self.epsilon / (10.0 * diagonal) * self.graph.aspect(v, w)
            heapq.heappush(self.heap, (penalty, v, w, self.version[v], self.version[w], concavity))

    def pop(self) -> tuple[int, int, float] | None:
        """Return the pair of least penalty and its concavity; None if no pair is left."""
        while self.heap:
            _, v, w, at_v, at_w, concavity = heapq.heappop(self.heap)
            if self.version.get(v) != at_v or self.version.get(w) != at_w:
                continue
            if concavity is not None:
                return v, w, concavity
            concavity = self.graph.united_concavity(v, w)
            self.graph.know(v, w, concavity)
            self.push(v, w, concavity)
        return None

    def renew(self, v: int, w: int) -> None:
        """Replace the pairs of two patches after the contraction of w into v."""
        self.version[v] += 1
        del self.version[w]
        for other in sorted(self.graph.border[v]):
            self.push(v, other)


def convex_patches(
    vertices: Floats, triangles: Int64s, epsilon: float, stop: Callable[[], bool]
) -> list[Int64s] | None:
    """Return patches as arrays of triangles; None if stopped early.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``, a mesh.
    epsilon
        Largest concavity of a patch, mm.
    stop
        Ends the search.
    """
    graph = DualGraph(vertices, triangles)
    queue = PairQueue(graph, epsilon)
    for v, neighbours in graph.border.items():
        for w in neighbours:
            if v < w:
                queue.push(v, w)
    while (pair := queue.pop()) is not None:
        if stop():
            return None
        v, w, concavity = pair
        graph.contract(v, w, concavity)
        queue.renew(v, w)
    return [np.array(sorted(patch)) for _, patch in sorted(graph.triangles.items())]
