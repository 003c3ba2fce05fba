"""Request to a cell emitter, and its answer."""

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import numpy as np

from amprep.arrays import Bytes, Floats, Ints, frozen
from amprep.geometry.voxels.grid import Grid
from amprep.model.mesh import Mesh
from amprep.model.supports.edges import DIRECTIONS, SupportEdges


class Role(IntEnum):
    """Role of an edge in its support."""

    TRUNK = 0
    FOOT = 1
    """The lower square of the edge is on the plate."""
    CONNECTOR = 2
    """The edge runs from a red square straight up into the part; the host trims it to the faces it supports."""


@dataclass(frozen=True, eq=False)
class CellRequest:
    """Edges that geometry is to replace (thesis 3.5).

    Attributes
    ----------
    grid
        Grid of the supports.
    edges
        ``n`` edges with their flow (number of paths) and their support group. A connector edge is vertical, and its
        lower square is its red square.
    role
        ``(n,)`` uint8, values of `Role`.
    parts
        Placed part meshes in build coordinates.
    gap
        Smallest horizontal distance between supports and parts, mm.
    overlap
        Depth to which connectors enter the part, mm.
    allow_surface
        Whether the target can read walls without thickness.
    beams
        True: struts become beams if the cell supports them; False: no beams; None: the parameters of the cell decide.
    least_wall
        Least thickness of supports, mm, for the default sizes of cells; sizes that the user chooses take precedence.
    leg_ratio
        Largest ratio of length to width of a leg, for the default sizes of cells, too; 0 for no limit.

    Raises
    ------
    ValueError
        If there are not as many roles as edges.
    """

    grid: Grid
    edges: SupportEdges
    role: Bytes
    parts: tuple[Mesh, ...] = ()
    gap: float = 0.0
    overlap: float = 0.1
    allow_surface: bool = True
    beams: bool | None = None
    least_wall: float = 0.0
    leg_ratio: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "role", frozen(self.role, np.uint8))
        if len(self.role) != len(self.edges):
            raise ValueError(
                f"a request has one role for each of its {len(self.edges)} edges, got {len(self.role)}"
            )

    @cached_property
    def matrices(self) -> Floats:
        """``(n, 3, 4)``, unit cube to the upright or sheared prism of each edge in build coordinates (thesis 3.5)."""
        grid, edges = self.grid, self.edges
        dy, dx = np.array(DIRECTIONS, np.float64)[edges.direction].T
        matrices = np.zeros((len(edges), 3, 4))
        matrices[:, 0, 0] = matrices[:, 1, 1] = grid.pitch
        matrices[:, 2, 2] = grid.step
        matrices[:, 0, 2], matrices[:, 1, 2] = -dx * grid.pitch, -dy * grid.pitch
        lower = np.column_stack([edges.x + dx, edges.y + dy, edges.plane - 1.0])
        matrices[:, :, 3] = grid.origin + lower * (grid.pitch, grid.pitch, grid.step)
        return frozen(matrices, np.float64)


@dataclass(frozen=True, eq=False)
class Template:
    """A shape in the unit cube, whose bottom is the lower square of an edge and whose top is the upper one.

    It is a closed solid or, with `surface`, an open sheet that a machine must not fill. Shapes that meet, one on
    another or side by side under the same shear, should conform: their common faces have the same triangles.
    """

    name: str
    mesh: Mesh
    surface: bool = False


@dataclass(frozen=True, eq=False)
class Beams:
    """Round beams between nodes.

    Attributes
    ----------
    nodes
        ``(n, 3)`` mm, build coordinates.
    struts
        ``(m, 2)`` int32, indices into `nodes`.
    radii
        ``(m, 2)`` mm, at both ends of each beam.
    group
        ``(m,)`` support group of each beam.
    """

    nodes: Floats
    struts: Ints
    radii: Floats
    group: Ints


@dataclass(frozen=True, eq=False)
class ExtraMesh:
    """A finished mesh in build coordinates for one support group."""

    mesh: Mesh
    group: int
    surface: bool = False


@dataclass(frozen=True, eq=False)
class Cells:
    """Templates and their instances; the host expands, trims and unites them.

    Attributes
    ----------
    template, edge
        ``(n,)`` int32: template of each instance, and the edge of the request that it replaces. The edge gives the
        instance its group and role.
    matrix
        ``(n, 3, 4)`` float64, unit cube to build coordinates.
    extra
        Finished meshes beside the instances.
    beams
        Beams instead of templates, if the request allows them.
    hole
        Diameter (mm) of a ball that must be able to escape; where it cannot, the host cuts a drain hole. 0 for none.
    """

    templates: tuple[Template, ...]
    template: Ints
    edge: Ints
    matrix: Floats
    extra: tuple[ExtraMesh, ...] = ()
    beams: Beams | None = None
    hole: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "template", frozen(self.template, np.int32))
        object.__setattr__(self, "edge", frozen(self.edge, np.int32))
        object.__setattr__(self, "matrix", frozen(self.matrix, np.float64).reshape(-1, 3, 4))
