"""Parameters of the built-in volume makers."""

from dataclasses import dataclass

from amprep.validation import require, require_bounds


@dataclass(frozen=True)
class BoundingMeshParams:
    """Parameters of `bounding-mesh`.

    Attributes
    ----------
    triangles
        Number of triangles; None takes `fraction`.
    fraction
        Number of triangles as a fraction of those of the part; None, without `triangles`, is a tenth, but at least
        1,000 triangles: few triangles around many holes add much volume.
    max_error_mm
        Greatest distance (mm) of any point of the new surface from the surface of the part; None for no limit. With a
        limit, more triangles may be left than asked for.
    cost
        ``volume``: contract the edge that adds the least volume; ``distance``: the one with the least sum of squared
        distances to the planes around it.
    """

    triangles: int | None = None
    fraction: float | None = None
    max_error_mm: float | None = None
    cost: str = "volume"

    def __post_init__(self) -> None:
        require(self.cost in {"volume", "distance"}, "cost must be volume or distance", repr(self.cost))
        require_bounds(self, "triangles", at_least=4)
        require_bounds(self, "fraction", at_least=0.0, at_most=1.0)
        require_bounds(self, "max_error_mm", above=0.0)

    def target(self, count: int) -> int:
        """Return the number of triangles to reach for a part of `count` triangles."""
        if self.triangles is not None:
            return self.triangles
        wanted = max(0.1 * count, 1000.0) if self.fraction is None else self.fraction * count
        return max(4, int(wanted))


@dataclass(frozen=True)
class TwoBoxesParams:
    """Parameters of `boxes-two`.

    Attributes
    ----------
    objective
        ``union``: least volume of the union of both boxes; ``larger``: least volume of the larger box.
    planes
        Greatest number of planes along each axis at which a face of a box is tried before the best places are
        refined. Sets with no more distinct coordinates than this are solved exactly.
    """

    objective: str = "union"
    planes: int = 48

    def __post_init__(self) -> None:
        known = self.objective in {"union", "larger"}
        require(known, "objective must be union or larger", repr(self.objective))
        require_bounds(self, "planes", at_least=2, at_most=256)


@dataclass(frozen=True)
class BranchAndCutParams:
    """Parameters of `boxes-branch-and-cut`; the budget counts work, so that the same part gives the same boxes.

    Attributes
    ----------
    boxes
        Greatest number of boxes.
    cells
        Cells along the longest side of the part; with more of them the search is finer, and slower.
    work
        Millions of steps after which the search ends; some 15 per second. Finding boxes that fit the part exactly takes
        about a tenth of a second more.
    """

    boxes: int = 3
    cells: int = 16
    work: float = 0.6

    def __post_init__(self) -> None:
        require_bounds(self, "boxes", at_least=2, at_most=4)
        require_bounds(self, "cells", at_least=2, at_most=64)
        require_bounds(self, "work", at_least=0, at_most=1_000_000)


@dataclass(frozen=True)
class KMeansParams:
    """Parameters of `boxes-kmeans`.

    Attributes
    ----------
    boxes
        Number of clusters, and greatest number of boxes.
    restarts
        Number of random starts; the boxes of least union count.
    cells
        The surface is clustered by cells, as many as this along the longest side of the part.
    rotate
        Whether a part that may be rotated freely or about z is rotated to the best common orientation of the
        clusters.
    """

    boxes: int = 3
    restarts: int = 20
    cells: int = 40
    rotate: bool = True

    def __post_init__(self) -> None:
        require_bounds(self, "boxes", at_least=2, at_most=5)
        require_bounds(self, "restarts", at_least=1, at_most=10_000)
        require_bounds(self, "cells", at_least=2, at_most=256)


@dataclass(frozen=True)
class ConvexPiecesParams:
    """Parameters of `convex-pieces`.

    Attributes
    ----------
    method
        ``cuts``: planes cut the solid into cells, and cells are merged. ``surface``: nearly convex patches of the
        surface (Mamou, Ghorbel), and cells where their hulls leave the interior uncovered; slower.
    pieces
        Greatest number of pieces.
    excess
        Excess of the total volume of the pieces over the volume of the part, as a fraction of it, up to which
        fewer pieces are preferred.
    concavity_mm
        Parts of the solid that are no deeper below their hull than this are not cut further; 0 for no limit. For
        ``surface`` the largest concavity of a patch; 0 for 2 % of the diagonal of the part.
    """

    method: str = "cuts"
    pieces: int = 32
    excess: float = 0.02
    concavity_mm: float = 0.0

    def __post_init__(self) -> None:
        known = self.method in {"cuts", "surface"}
        require(known, "method must be cuts or surface", repr(self.method))
        require_bounds(self, "pieces", at_least=1, at_most=1000)
        require_bounds(self, "excess", "concavity_mm", at_least=0)


@dataclass(frozen=True)
class TwoRectanglesParams:
    """Parameters of `rectangles-two`.

    Attributes
    ----------
    objective
        ``union``: least area of the union of both rectangles; ``larger``: least area of the larger one.
    """

    objective: str = "union"

    def __post_init__(self) -> None:
        known = self.objective in {"union", "larger"}
        require(known, "objective must be union or larger", repr(self.objective))
