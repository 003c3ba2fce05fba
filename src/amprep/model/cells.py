"""What a cell emitter is asked and what it answers."""

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import numpy as np

from amprep.arrays import Bytes, Floats, Ints, frozen
from amprep.geometry.voxels.grid import Grid
from amprep.model.mesh import Mesh
from amprep.model.support_edges import DIRECTIONS


class Role(IntEnum):
    """Where an edge stands in its support."""

    TRUNK = 0
    FOOT = 1
    """Its lower square lies on the plate."""
    CONNECTOR = 2
    """Stands on a red square and runs straight up into the part; the host trims it to the faces it holds."""


@dataclass(frozen=True, eq=False)
class CellRequest:
    """Edges to be replaced by geometry (thesis 3.5).

    A trunk or foot edge leads from square (plane, y, x) to (plane - 1, y + dy, x + dx). A connector edge
    has direction 0 and leads from (plane, y, x) down to (plane - 1, y, x), where (plane - 1, y, x) is its red square.

    Attributes
    ----------
    plane, y, x, load, group
        ``(n,)`` int32; load is the number of paths, group the support group (index).
    direction, role
        ``(n,)`` uint8; indices into `DIRECTIONS`, values of `Role`.
    parts
        Placed part meshes in build coordinates.
    gap
        Least distance between supports and parts sideways, mm.
    overlap
        How far connectors run into the part, mm.
    allow_surface
        Whether the target can read walls without thickness.
    beams
        True: struts as beams where the cell can; False: no beams; None: as the cell's parameters say.
    """

    frame: Grid
    plane: Ints
    y: Ints
    x: Ints
    direction: Bytes
    role: Bytes
    load: Ints
    group: Ints
    parts: tuple[Mesh, ...] = ()
    gap: float = 0.0
    overlap: float = 0.1
    allow_surface: bool = True
    beams: bool | None = None

    def __post_init__(self) -> None:
        for name in ("plane", "y", "x", "load", "group"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int32))
        for name in ("direction", "role"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.uint8))

    @cached_property
    def matrices(self) -> Floats:
        """``(n, 3, 4)`` unit cube to build coordinates: the upright or sheared prism of each edge (thesis 3.5)."""
        frame = self.frame
        dy, dx = np.array(DIRECTIONS, np.float64)[self.direction].T
        matrices = np.zeros((len(self.plane), 3, 4))
        matrices[:, 0, 0] = matrices[:, 1, 1] = frame.pitch
        matrices[:, 2, 2] = frame.step
        matrices[:, 0, 2], matrices[:, 1, 2] = -dx * frame.pitch, -dy * frame.pitch
        lower = np.column_stack([self.x + dx, self.y + dy, self.plane - 1.0])
        matrices[:, :, 3] = frame.origin + lower * (frame.pitch, frame.pitch, frame.step)
        return frozen(matrices, np.float64)


@dataclass(frozen=True, eq=False)
class Template:
    """A shape in the unit cube; z = 0 is the lower square, z = 1 the upper one.

    A closed solid, or with `surface` an open sheet that a machine must not fill. Shapes that stand on one
    another, or side by side under the same shear, conform: where their faces meet, they share the same triangles.
    """

    name: str
    mesh: Mesh
    surface: bool = False


@dataclass(frozen=True, eq=False)
class Beams:
    """Round beams: nodes ``(n, 3)`` mm, struts ``(m, 2)`` int32, radii ``(m, 2)`` mm at both ends, group ``(m,)``."""

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
    """Templates and where they go; the host expands, trims, welds and merges.

    Attributes
    ----------
    template, edge
        ``(n,)`` int32: which template; which edge of the request it replaces (gives group, role and load).
    matrix
        ``(n, 3, 4)`` float64: unit cube to build coordinates.
    hole
        mm; a ball that wide has to get out from between the cells: the host cuts a way where it does not. 0
        for none.
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
