"""Frozen records that flow between the stages. Millimetres and radians; arrays are read-only."""

from amprep.arrays import CONTACT_TOLERANCE
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid
from amprep.model.build import (
    TARGETS,
    Build,
    BuildSettings,
    Lattice,
    PlacedPart,
    SupportBody,
    Target,
    Unsupported,
)
from amprep.model.build_volume import BuildVolume
from amprep.model.cell_shapes import DeclaredCell, GraphCell, ImplicitCell, MeshCell, Shape, Variant, When
from amprep.model.cells import Beams, CellRequest, Cells, ExtraMesh, Role, Template
from amprep.model.control import Report, Stop, silent
from amprep.model.mesh import Mesh
from amprep.model.packing import Item, Objective, Packing, PackingProblem, Placement, Unplaced
from amprep.model.part import Appearance, Orientations, Overrides, Part, Region
from amprep.model.supports import DIRECTIONS, Cube, GridFrame, SupportPlan, SupportProblem, Unconnected

__all__ = [
    "CONTACT_TOLERANCE",
    "DIRECTIONS",
    "TARGETS",
    "Appearance",
    "Beams",
    "BoundingVolume",
    "Boxes",
    "Build",
    "BuildSettings",
    "BuildVolume",
    "CellRequest",
    "Cells",
    "ConvexPieces",
    "Cube",
    "DeclaredCell",
    "ExtraMesh",
    "GraphCell",
    "GridFrame",
    "ImplicitCell",
    "Item",
    "Lattice",
    "Mesh",
    "MeshCell",
    "Objective",
    "Orientations",
    "Overrides",
    "Packing",
    "PackingProblem",
    "Part",
    "PlacedPart",
    "Placement",
    "Region",
    "Report",
    "Role",
    "Shape",
    "Solid",
    "Stop",
    "SupportBody",
    "SupportPlan",
    "SupportProblem",
    "Target",
    "Template",
    "Unconnected",
    "Unplaced",
    "Unsupported",
    "Variant",
    "When",
    "silent",
]
