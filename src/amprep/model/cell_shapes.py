"""Declaration of a lattice cell: shapes in the unit cube, and the edges that each of them replaces."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from amprep.arrays import Floats, Ints, frozen
from amprep.model.mesh import Mesh
from amprep.validation import require, require_bounds

RoleWord = Literal["trunk", "surface", "foot", "connector"]
EdgeWord = Literal["any", "straight", "oblique"]

ROLE_WORDS: tuple[RoleWord, ...] = ("trunk", "surface", "foot", "connector")
EDGE_WORDS: tuple[EdgeWord, ...] = ("any", "straight", "oblique")


@dataclass(frozen=True, eq=False)
class GraphCell:
    """Round struts and walls between points. Only this kind of cell keeps its thickness when it is sheared.

    Points on the sides of the cube are the ports of the cell; opposite sides should have the same ports. A strut
    between two points of one side is shared with the neighbour there: each cell contains half of it, lengthwise.

    Attributes
    ----------
    points
        ``(n, 3)`` in the unit cube; z = 0 is the lower square, z = 1 the upper one.
    struts
        ``(m, 2)`` int32, indices into `points`.
    radius
        ``(m, 2)`` mm at both ends of each strut, after the map. One number, or one for each strut, is accepted as well.
    faces
        ``(k, 3)`` int32, walls as triangles over `points`.
    thickness
        Thickness of the walls, mm; 0 makes sheets, which a machine must not fill.
    growth, full_load
        Edges with `full_load` paths or more have `growth` times the radii of an edge with one path. In between, the
        cross-section grows linearly.
    """

    points: Floats
    struts: Ints = field(default_factory=lambda: np.empty((0, 2), np.int32))
    radius: Floats | float = 0.3
    faces: Ints = field(default_factory=lambda: np.empty((0, 3), np.int32))
    thickness: float = 0.0
    growth: float = 1.0
    full_load: int = 2

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points, np.float64, 3))
        object.__setattr__(self, "struts", frozen(self.struts, np.int32, 2))
        object.__setattr__(self, "faces", frozen(self.faces, np.int32, 3))
        radius = np.asarray(self.radius, np.float64)
        rows = radius[:, None] if radius.ndim == 1 else radius
        object.__setattr__(
            self, "radius", frozen(np.broadcast_to(rows, (len(self.struts), 2)), np.float64, 2)
        )
        require(bool(len(self.struts) or len(self.faces)), "a graph must have struts or faces", "neither")
        for name in ("struts", "faces"):
            used = getattr(self, name)
            within = not len(used) or (used.min() >= 0 and used.max() < len(self.points))
            require(within, f"{name} must refer to points 0 to {len(self.points) - 1}", used.tolist())
        ends = np.sort(self.struts, axis=1)
        require(
            bool((ends[:, 0] < ends[:, 1]).all()),
            "a strut must join two different points",
            "the same point twice",
        )
        outside = ~((self.points >= 0.0) & (self.points <= 1.0)).all()
        require(not outside, "points must be inside the unit cube", np.asarray(self.points).tolist())
        require(
            bool((self.radii > 0.0).all() and np.isfinite(self.radii).all()), "radii must be above 0", radius
        )
        require_bounds(self, "thickness", at_least=0, below=np.inf)
        require_bounds(self, "growth", at_least=1, at_most=10)
        require_bounds(self, "full_load", at_least=2)

    @property
    def radii(self) -> Floats:
        """``(m, 2)`` mm at both ends of each strut, for an edge with one path."""
        return np.asarray(self.radius)

    @property
    def is_sheet(self) -> bool:
        """Whether the cell has walls, and these have no thickness."""
        return len(self.faces) > 0 and self.thickness == 0.0


@dataclass(frozen=True, eq=False)
class MeshCell:
    """A closed mesh in the unit cube, or with `surface` an open mesh that a machine must not fill."""

    mesh: Mesh
    surface: bool = False


@dataclass(frozen=True, eq=False)
class ImplicitCell:
    """A periodic function of the point that is positive inside the cell.

    Attributes
    ----------
    function
        Takes points ``(n, 3)`` and returns values ``(n,)``. It is evaluated slightly outside the unit cube too, and
        must have the unit cube as its period: f(0, y, z) = f(1, y, z), and so on.
    resolution
        Steps along each edge of the cube of the grid on which the function is meshed, 4 to 100.
    """

    function: Callable[[Floats], Floats]
    resolution: int = 20

    def __post_init__(self) -> None:
        require_bounds(self, "resolution", at_least=4, at_most=100)


Shape = GraphCell | MeshCell | ImplicitCell


@dataclass(frozen=True)
class When:
    """Conditions on an edge, all of which must hold.

    Attributes
    ----------
    roles
        Words of `ROLE_WORDS`, or nothing for all roles. A ``surface`` edge is a trunk edge that lacks a neighbour of
        its direction on some side.
    edges
        Direction of the edge: straight, oblique or any.
    least_load, most_load
        Bounds of the number of paths on the edge.
    every, layer
        The number of the layer (0 is on the plate) must leave the remainder `layer` when divided by `every`.
    """

    roles: frozenset[str] = frozenset()
    edges: EdgeWord = "any"
    least_load: int = 0
    most_load: int = 1_000_000_000
    every: int = 1
    layer: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "roles", frozenset(self.roles))
        unknown = sorted(self.roles - set(ROLE_WORDS))
        require(not unknown, f"roles must be among {', '.join(ROLE_WORDS)}", ", ".join(unknown))
        require(self.edges in EDGE_WORDS, f"edges must be one of {', '.join(EDGE_WORDS)}", self.edges)
        require(self.least_load <= self.most_load, "least_load must be at most most_load", self.least_load)
        require_bounds(self, "every", at_least=1)
        require(0 <= self.layer < self.every, "layer must be at least 0 and below every", self.layer)


@dataclass(frozen=True, eq=False)
class Variant:
    """A shape, and conditions on the edges that it replaces."""

    shape: Shape
    when: When = field(default_factory=When)


@dataclass(frozen=True, eq=False)
class DeclaredCell:
    """A cell with variants; the first variant that fits an edge replaces it.

    Edges that no variant fits stay empty.

    Attributes
    ----------
    variants
        Shapes with their conditions, in order of precedence.
    author, licence
        Author and licence that lists of cells show.
    smallest_feature
        Smallest thickness (mm) of the cell, or None for the usual limit. `amprep cells check` judges it.
    least_angle_deg
        Smallest angle of a strut or face to the horizontal, even on oblique edges, or None for the usual limit.
    """

    variants: tuple[Variant, ...]
    author: str = ""
    licence: str = ""
    smallest_feature: float | None = None
    least_angle_deg: float | None = None

    @classmethod
    def of(cls, cell: "Shape | DeclaredCell") -> "DeclaredCell":
        """Return a cell unchanged, and a single shape as a cell with one variant.

        Raises
        ------
        TypeError
            For anything else.
        """
        if not isinstance(cell, DeclaredCell | GraphCell | MeshCell | ImplicitCell):
            raise TypeError(f"expected a shape or a DeclaredCell, got {type(cell).__name__}")
        return cell if isinstance(cell, DeclaredCell) else cls((Variant(cell),))

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of its shapes: ``graph``, ``mesh``, ``implicit``."""
        words = {GraphCell: "graph", MeshCell: "mesh", ImplicitCell: "implicit"}
        return tuple(dict.fromkeys(words[type(variant.shape)] for variant in self.variants))
