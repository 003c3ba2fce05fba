"""A build as one list of triangles with colours, for pictures."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats, Ints
from amprep.model import Build, Mesh
from amprep.report.picture.colours import SUPPORT, UNSUPPORTED, part_colours, rgb
from amprep.report.picture.marks import balls, mark_radius, thinned

PLATE_KIND, PART_KIND, SUPPORT_KIND = 0, 1, 2
"""The kinds of `amprep.kernels.raster`, repeated here so that scenes can be made without the compiler."""
PLATE_COLOUR = "#ccd2da"


@dataclass(frozen=True, eq=False)
class Scene:
    """Triangles ``(m, 3)`` over vertices ``(n, 3)`` mm; kind, body and linear colour ``(m, 3)`` of each."""

    vertices: Floats
    triangles: Ints
    kinds: NDArray[np.uint8]
    owner: Ints
    colours: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Body:
    """A mesh with its colour ``#rrggbb`` and kind."""

    mesh: Mesh
    colour: str
    kind: int


def build_bodies(build: Build) -> list[Body]:
    """Return the parts and supports of a build."""
    parts = [
        Body(placed.mesh, colour, PART_KIND)
        for placed, colour in zip(build.parts, part_colours(build), strict=True)
    ]
    return parts + [Body(body.mesh, SUPPORT, SUPPORT_KIND) for body in build.supports]


def plate_body(low: Floats, high: Floats) -> Body:
    """Return a rectangle of the plate z = 0 between two corners, facing up."""
    corners = [[low[0], low[1], 0], [high[0], low[1], 0], [high[0], high[1], 0], [low[0], high[1], 0]]
    return Body(
        Mesh(np.array(corners, np.float64), np.array([[0, 1, 2], [0, 2, 3]])), PLATE_COLOUR, PLATE_KIND
    )


def unsupported_marks(build: Build, least_radius: float) -> Body | None:
    """Return small balls over every point that is unsupported, specks below the least size left out; None for none."""
    regions = [region for region in build.unsupported if len(region.points) and not region.minor]
    if not regions:
        return None
    points = [thinned(region.points) for region in regions]
    radii = [
        np.full(len(some), mark_radius(region.radius, least_radius))
        for some, region in zip(points, regions, strict=True)
    ]
    return Body(balls(np.concatenate(points), np.concatenate(radii)), UNSUPPORTED, PART_KIND)


def assemble(bodies: list[Body]) -> Scene:
    """Return the bodies as one scene; body k owns the triangles with ``owner == k``."""
    starts = np.cumsum([0, *(len(body.mesh.vertices) for body in bodies)])
    counts = [len(body.mesh.triangles) for body in bodies]
    return Scene(
        vertices=np.concatenate([body.mesh.vertices for body in bodies]),
        triangles=np.concatenate(
            [body.mesh.triangles + np.int32(start) for body, start in zip(bodies, starts[:-1], strict=True)]
        ),
        kinds=np.repeat(np.array([body.kind for body in bodies], np.uint8), counts),
        owner=np.repeat(np.arange(len(bodies), dtype=np.int32), counts),
        colours=np.repeat(np.array([linear(body.colour) for body in bodies], np.float32), counts, axis=0),
    )


def linear(colour: str) -> tuple[float, float, float]:
    """Return ``#rrggbb`` as linear light in [0, 1]."""
    red, green, blue = (
        (share + 0.055) / 1.055 if share > 0.04045 else share / 12.92 for share in rgb(colour)
    )
    return red**2.4, green**2.4, blue**2.4


def unit_normals(vertices: Floats, triangles: Ints) -> Floats:
    """Return ``(m, 3)`` unit normals; zero for triangles without area."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Floats = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    return unit
