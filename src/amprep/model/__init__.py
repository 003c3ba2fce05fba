"""Data records: meshes, parts, problems, plans and builds. Lengths in mm, angles in radians; read-only arrays."""

from amprep.arrays import CONTACT_TOLERANCE
from amprep.geometry.voxels.grid import Grid
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid, TurnedVolume
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
from amprep.model.control import Progress, Stop, silent
from amprep.model.mesh import Mesh
from amprep.model.packing import Item, Objective, Packing, PackingProblem, Placement, Unplaced
from amprep.model.part import Appearance, Orientations, Overrides, Part, Region
from amprep.model.supports import (
    CAPACITY,
    ENCLOSED,
    OUT_OF_TIME,
    SupportPlan,
    SupportProblem,
    Unconnected,
    Voxel,
)
from amprep.model.supports.edges import DIRECTIONS, SupportEdges

__all__ = [
    "CAPACITY",
    "CONTACT_TOLERANCE",
    "DIRECTIONS",
    "ENCLOSED",
    "OUT_OF_TIME",
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
    "DeclaredCell",
    "ExtraMesh",
    "GraphCell",
    "Grid",
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
    "Progress",
    "Region",
    "Role",
    "Shape",
    "Solid",
    "Stop",
    "SupportBody",
    "SupportEdges",
    "SupportPlan",
    "SupportProblem",
    "Target",
    "Template",
    "TurnedVolume",
    "Unconnected",
    "Unplaced",
    "Unsupported",
    "Variant",
    "Voxel",
    "When",
    "silent",
]
