"""Measure a mesh: size, volume, area, shells, genus, and edges that are open or shared by too many triangles."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, Int64s
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import count_edges
from amprep.model.part import Part


@dataclass(frozen=True)
class MeshContents:
    """Figures of a mesh.

    Attributes
    ----------
    size_mm
        Sides of the bounding box.
    low_mm
        Its lowest corner.
    volume_mm3
        Volume of the solid, where overlaps count once; None for a surface.
    overlap_mm3
        Volume that is enclosed more than once, counted for each time but the first; None for a surface.
    area_mm2
        Area of all triangles.
    bodies, cavities
        Number of shells that enclose material, and of shells that enclose a void in it; for a surface, all connected
        components are bodies.
    genus
        Number of handles of all shells together; None for a surface.
    open_edges
        Edges with an odd number of triangles, or whose triangles do not match.
    nonmanifold_edges
        Edges at which more than two triangles meet: the surface touches itself there.
    """

    triangles: int
    vertices: int
    size_mm: tuple[float, float, float]
    low_mm: tuple[float, float, float]
    volume_mm3: float | None
    overlap_mm3: float | None
    area_mm2: float
    bodies: int
    cavities: int
    genus: int | None
    open_edges: int
    nonmanifold_edges: int


def measure_contents(part: Part) -> MeshContents:
    """Return the figures of the mesh of a part, which must be valid but need not be a solid."""
    vertices, triangles = part.mesh.arrays
    low, high = part.mesh.bounds
    _, uses, balance = count_edges(triangles)
    bodies, cavities, genus = _topology(vertices, triangles) if part.is_solid else (None, 0, None)
    return MeshContents(
        triangles=len(triangles),
        vertices=len(np.unique(triangles)),
        size_mm=_triple(high - low),
        low_mm=_triple(low),
        volume_mm3=part.volume_mm3 if part.is_solid else None,
        overlap_mm3=_overlap(part) if part.is_solid else None,
        area_mm2=_area(vertices, triangles),
        bodies=label_shells(triangles, len(vertices))[0] if bodies is None else bodies,
        cavities=cavities,
        genus=genus,
        open_edges=int(((uses % 2 == 1) | (balance != 0)).sum()),
        nonmanifold_edges=int((uses > 2).sum()),
    )


def _overlap(part: Part) -> float:
    """Return the enclosed volume minus the volume of the solid; rounding is no overlap."""
    overlap = part.mesh.signed_volume - part.volume_mm3
    return overlap if overlap > 1e-6 * part.volume_mm3 else 0.0


def _topology(vertices: Floats, triangles: Int64s) -> tuple[int | None, int, int | None]:
    """Return the numbers of bodies, cavities and handles; manifold3d splits edges of more than two triangles."""
    solid = as_manifold(vertices, triangles)
    if not accepted(solid):
        return None, 0, None
    volumes = np.array([shell.volume() for shell in solid.decompose()])
    euler = solid.num_vert() - solid.num_edge() + solid.num_tri()
    return int((volumes > 0.0).sum()), int((volumes < 0.0).sum()), len(volumes) - euler // 2


def _area(vertices: Floats, triangles: Int64s) -> float:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def _triple(values: Floats) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z
