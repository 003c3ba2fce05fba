"""A lattice cell as an engineer declares it: a shape in the unit cube, apart from where it is put."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from amprep.arrays import Floats, Ints, frozen
from amprep.model.mesh import Mesh

RoleWord = Literal["trunk", "surface", "foot", "connector"]
EdgeWord = Literal["any", "straight", "oblique"]

ROLE_WORDS: tuple[RoleWord, ...] = ("trunk", "surface", "foot", "connector")
EDGE_WORDS: tuple[EdgeWord, ...] = ("any", "straight", "oblique")


@dataclass(frozen=True, eq=False)
class GraphCell:
    """Round struts between points, walls between points; the only kind whose thickness survives shear.

    Points on the sides of the cube are the cell's ports: what is on one side is to be on the opposite one as
    well. A strut between points of one side is shared with the neighbour there, and so cut lengthwise.

    Attributes
    ----------
    points
        ``(n, 3)`` in the unit cube: z = 0 is the lower square, z = 1 the upper one.
    struts
        ``(m, 2)`` int32, indices into `points`.
    radius
        ``(m, 2)`` mm at both ends of each strut, whatever the map; given as one number, one for each strut, or two.
    faces
        ``(k, 3)`` int32, triangles over `points`: walls.
    thickness
        mm, of the walls; 0 makes them sheets without thickness, which a machine must not fill.
    growth, full_load
        Radii of an edge with `full_load` paths or more are `growth` times those of one with a single path;
        in between the cross-section grows evenly.
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
        _require(bool(len(self.struts) or len(self.faces)), "a graph has struts or faces", "neither")
        for name in ("struts", "faces"):
            used = getattr(self, name)
            within = not len(used) or (used.min() >= 0 and used.max() < len(self.points))
            _require(within, f"{name} name points from 0 to {len(self.points) - 1}", used.tolist())
        ends = np.sort(self.struts, axis=1)
        _require(bool((ends[:, 0] < ends[:, 1]).all()), "a strut joins two points", "one twice")
        outside = ~((self.points >= 0.0) & (self.points <= 1.0)).all()
        _require(not outside, "points lie in the unit cube", np.asarray(self.points).tolist())
        _require(
            bool((self.radii > 0.0).all() and np.isfinite(self.radii).all()), "radii are above 0", radius
        )
        _require(0.0 <= self.thickness < np.inf, "thickness is 0 or more", self.thickness)
        _require(1.0 <= self.growth <= 10.0, "growth is between 1 and 10", self.growth)
        _require(self.full_load >= 2, "full_load is at least 2", self.full_load)

    @property
    def radii(self) -> Floats:
        """``(m, 2)`` mm at both ends of each strut, for an edge with a single path."""
        return np.asarray(self.radius)

    @property
    def is_sheet(self) -> bool:
        """Whether its walls have no thickness."""
        return len(self.faces) > 0 and self.thickness == 0.0


@dataclass(frozen=True, eq=False)
class MeshCell:
    """A closed mesh in the unit cube, or with `surface` an open one that a machine must not fill."""

    mesh: Mesh
    surface: bool = False


@dataclass(frozen=True, eq=False)
class ImplicitCell:
    """A function of the point, positive inside.

    Attributes
    ----------
    function
        Takes points ``(n, 3)``, gives values ``(n,)``. It is also asked a little outside the unit cube and
        has to go on there as in the neighbouring cell: f(0, y, z) = f(1, y, z) and so on.
    resolution
        Steps along each side of the cube when it is turned into triangles.
    """

    function: Callable[[Floats], Floats]
    resolution: int = 20

    def __post_init__(self) -> None:
        _require(4 <= self.resolution <= 100, "resolution is between 4 and 100", self.resolution)


Shape = GraphCell | MeshCell | ImplicitCell


@dataclass(frozen=True)
class When:
    """Which edges a variant is for; every condition has to hold.

    Attributes
    ----------
    roles
        Words of `ROLE_WORDS`; ``surface`` is a trunk edge beside which an edge of its direction is missing.
        Empty: all.
    edges
        Straight ones, oblique ones, or any.
    least_load, most_load
        Number of paths on the edge.
    every, layer
        Layers (0 stands on the plate) that leave the remainder `layer` when divided by `every`.
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
        _require(not unknown, f"roles are among {', '.join(ROLE_WORDS)}", ", ".join(unknown))
        _require(self.edges in EDGE_WORDS, f"edges is one of {', '.join(EDGE_WORDS)}", self.edges)
        _require(self.least_load <= self.most_load, "least_load is at most most_load", self.least_load)
        _require(self.every >= 1, "every is at least 1", self.every)
        _require(0 <= self.layer < self.every, "layer is at least 0 and below every", self.layer)


@dataclass(frozen=True, eq=False)
class Variant:
    """A shape and the edges it is for."""

    shape: Shape
    when: When = field(default_factory=When)


@dataclass(frozen=True, eq=False)
class DeclaredCell:
    """A cell apart from where it is put: of its variants the first that fits an edge replaces it.

    Edges that no variant fits stay empty.

    Attributes
    ----------
    least_angle_deg
        Its promise: no strut and no face comes out flatter than this on an oblique edge; None for the usual bound.
    smallest_feature
        Its promise: nothing of it is thinner, mm; None for the usual bound.
    """

    variants: tuple[Variant, ...]
    author: str = ""
    licence: str = ""
    smallest_feature: float | None = None
    least_angle_deg: float | None = None

    @classmethod
    def of(cls, cell: "Shape | DeclaredCell") -> "DeclaredCell":
        """Return the cell as it is, or a single shape as a cell.

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
        """Which kinds of shape it has: ``graph``, ``mesh``, ``implicit``."""
        words = {GraphCell: "graph", MeshCell: "mesh", ImplicitCell: "implicit"}
        return tuple(dict.fromkeys(words[type(variant.shape)] for variant in self.variants))


def _require(holds: bool, rule: str, value: object) -> None:
    if not holds:
        raise ValueError(f"{rule}, got {value}")
