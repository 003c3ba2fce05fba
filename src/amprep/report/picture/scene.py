"""Collect the meshes of a build as one list of coloured triangles."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Bytes, Float32s, Floats, Ints
from amprep.model import Build, Mesh
from amprep.report.picture.colours import MARK_COLOURS, SUPPORT, part_colours, rgb
from amprep.report.picture.marks import balls, mark_radius, thinned
from amprep.report.triage.findings import Finding

PLATE_KIND, PART_KIND, SUPPORT_KIND = 0, 1, 2
"""The kinds of `amprep.kernels.picture.shade`, repeated here because importing that module takes time."""
SINGLE = 1.6
"""Factor on the size of a mark that is a single sphere, which would be overlooked."""
PLATE_COLOUR = "#ccd2da"
SEEN_THROUGH = "#e8edf4"
"""Colour of supports behind parts."""
FAR_MM = 1e4
"""A distance beyond all builds."""
ABOVE_LIFT_MM = 0.5
"""Height above the lift from which supports are visible through parts; connectors to lifted parts end below it."""


@dataclass(frozen=True, eq=False)
class TriangleScene:
    """All triangles of a picture.

    Attributes
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    kinds, owner, colours
        Kind ``(m,)``, index of the mesh ``(m,)`` and linear colour ``(m, 3)`` of each triangle.
    """

    vertices: Floats
    triangles: Ints
    kinds: Bytes
    owner: Ints
    colours: Float32s


@dataclass(frozen=True, eq=False)
class ColouredMesh:
    """A mesh with its colour ``#rrggbb`` and kind."""

    mesh: Mesh
    colour: str
    kind: int


def build_meshes(build: Build) -> list[ColouredMesh]:
    """Return the parts and supports of a build."""
    parts = [
        ColouredMesh(placed.mesh, colour, PART_KIND)
        for placed, colour in zip(build.parts, part_colours(build), strict=True)
    ]
    return parts + [ColouredMesh(body.mesh, SUPPORT, SUPPORT_KIND) for body in build.supports]


def plate_mesh(low: Floats, high: Floats) -> ColouredMesh:
    """Return the rectangle of the plane z = 0 between two corners, facing up."""
    corners = [[low[0], low[1], 0], [high[0], low[1], 0], [high[0], high[1], 0], [low[0], high[1], 0]]
    rectangle = Mesh(np.array(corners, np.float64), np.array([[0, 1, 2], [0, 2, 3]]))
    return ColouredMesh(rectangle, PLATE_COLOUR, PLATE_KIND)


def finding_marks(findings: Iterable[Finding], min_radius: float) -> list[ColouredMesh]:
    """Return small spheres at the points of what must be fixed and of what is worth a check."""
    marks = []
    for triage, colour in reversed(MARK_COLOURS.items()):
        own = [each for each in findings if each.triage == triage and len(each.points)]
        points = [thinned(each.points) for each in own]
        radii = [
            np.full(len(some), mark_radius(each.radius, min_radius) * (SINGLE if len(some) == 1 else 1.0))
            for some, each in zip(points, own, strict=True)
        ]
        if own:
            marks.append(
                ColouredMesh(balls(np.concatenate(points), np.concatenate(radii)), colour, PART_KIND)
            )
    return marks


def seen_through(build: Build, view: Floats) -> list[ColouredMesh]:
    """Return the supports of a build, moved far behind everything, so that they are faintly visible through parts.

    Supports below lifted parts are left out: they are seen from the side, and would cover the parts above them.

    Parameters
    ----------
    build
        The build.
    view
        ``(3,)`` direction in which the viewer looks.
    """
    found = []
    for body in build.supports:
        corners = body.mesh.vertices[body.mesh.triangles, 2]
        high = body.mesh.triangles[corners.mean(axis=1) > build.settings.lift + ABOVE_LIFT_MM]
        moved = Mesh(body.mesh.vertices + FAR_MM * view, high)
        found.append(ColouredMesh(moved, SEEN_THROUGH, SUPPORT_KIND))
    return found


def assemble(meshes: list[ColouredMesh]) -> TriangleScene:
    """Return all meshes as one scene; mesh k owns the triangles with ``owner == k``."""
    starts = np.cumsum([0, *(len(each.mesh.vertices) for each in meshes)])
    counts = [len(each.mesh.triangles) for each in meshes]
    return TriangleScene(
        vertices=np.concatenate([each.mesh.vertices for each in meshes]),
        triangles=np.concatenate(
            [each.mesh.triangles + np.int32(start) for each, start in zip(meshes, starts[:-1], strict=True)]
        ),
        kinds=np.repeat(np.array([each.kind for each in meshes], np.uint8), counts),
        owner=np.repeat(np.arange(len(meshes), dtype=np.int32), counts),
        colours=np.repeat(np.array([linear(each.colour) for each in meshes], np.float32), counts, axis=0),
    )


def linear(colour: str) -> tuple[float, float, float]:
    """Return ``#rrggbb`` as linear light in [0, 1]."""
    red, green, blue = (
        (value + 0.055) / 1.055 if value > 0.04045 else value / 12.92 for value in rgb(colour)
    )
    return red**2.4, green**2.4, blue**2.4


def unit_normals(vertices: Floats, triangles: Ints) -> Floats:
    """Return ``(m, 3)`` unit normals; zero for triangles without area."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Floats = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    return unit
