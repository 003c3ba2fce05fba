"""Check plates as polygons: the shadows of parts keep their distance from one another and from the walls.

A shadow is what a part covers of the plate, seen from above, with its holes. The check is for packings without
stacking; it uses the shadows that manifold3d projects, and no solid.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from amprep.arrays import Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.checks.violation import Violation
from amprep.geometry.meshes.distance import near_pairs
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model.build import PlacedPart
from amprep.model.build_volume import BuildVolume
from amprep.model.part import Part

if TYPE_CHECKING:
    from manifold3d import CrossSection

CHUNK = 256
"""Number of points whose distances to segments are computed at once."""


class Shadow(NamedTuple):
    """The shadow of a placed part, with its name."""

    label: str
    polygons: "CrossSection"


def shadows_of(parts: Sequence[PlacedPart]) -> list[Shadow]:
    """Return the shadows of placed parts; equal parts in equal orientations are projected once."""
    known: dict[tuple[int, bytes], CrossSection] = {}
    shadows = []
    for placed in parts:
        key = id(placed.part.mesh), placed.matrix[:3, :3].tobytes()
        if key not in known:
            known[key] = shadow_of(placed.part, placed.matrix[:3, :3])
        x, y = placed.matrix[:2, 3]
        shadows.append(Shadow(placed.label, known[key].translate((float(x), float(y)))))
    return shadows


def shadow_of(part: Part, rotation: Floats) -> "CrossSection":
    """Return the shadow of a part after a rotation about the origin of its coordinates."""
    from manifold3d import CrossSection, FillRule

    mesh = part.mesh
    if part.is_solid:
        turn = np.hstack([rotation, np.zeros((3, 1))])
        return as_manifold(mesh.vertices, mesh.triangles).transform(turn).project()
    flat = (mesh.vertices @ rotation.T)[mesh.triangles][:, :, :2]
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    back = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] < 0.0
    flat[back] = flat[back][:, ::-1]
    return CrossSection(list(flat), FillRule.NonZero)


def check_shadows(shadows: Sequence[Shadow], space: BuildVolume, clearance: float) -> list[Violation]:
    """Return the shadows of one plate that leave it, overlap, or are closer than the clearance.

    Parameters
    ----------
    shadows
        The shadows in build coordinates.
    space
        The build volume; its zones are not checked.
    clearance
        Least distance of shadows, and to the walls, mm.
    """
    shadows = [shadow for shadow in shadows if not shadow.polygons.is_empty()]  # of a vertical surface
    edges = [_edges(shadow.polygons) for shadow in shadows]
    found = []
    for shadow, own in zip(shadows, edges, strict=True):
        distance = _wall_distance(own[:, 0], space)
        if distance < clearance - TOLERANCE:
            message = f"its shadow is {distance:.4g} mm from the walls, expected at least {clearance:g} mm"
            found.append(Violation("shadow inside plate", shadow.label, message))
    lo = np.array([own[:, 0].min(axis=0) for own in edges]).reshape(-1, 2)
    hi = np.array([own[:, 0].max(axis=0) for own in edges]).reshape(-1, 2)
    for i, j in near_pairs(lo, hi, clearance - TOLERANCE):
        gap = _gap(shadows[i].polygons, shadows[j].polygons, edges[i], edges[j], clearance)
        if gap < clearance - TOLERANCE:
            message = f"its shadow is {gap:.4g} mm from that of {shadows[j].label}, expected at least {clearance:g} mm"
            found.append(Violation("shadows apart", shadows[i].label, message))
    return found


def _edges(polygons: "CrossSection") -> Floats:
    """Return the edges of all contours, ``(n, 2, 2)`` mm."""
    contours = [np.asarray(contour, np.float64) for contour in polygons.to_polygons()]
    return np.concatenate(
        [np.empty((0, 2, 2)), *(np.stack([c, np.roll(c, -1, axis=0)], axis=1) for c in contours)]
    )


def _wall_distance(points: Floats, space: BuildVolume) -> float:
    """Return the least distance of points ``(n, 2)`` to the walls, mm; negative outside."""
    if space.shape == "cylinder":
        radius = 0.5 * float(space.size[0])
        return radius - float(np.linalg.norm(points - 0.5 * space.size[:2], axis=1).max())
    return float(min(points.min(), (space.size[:2] - points).min()))


def _gap(
    one: "CrossSection", other: "CrossSection", edges: Floats, other_edges: Floats, limit: float
) -> float:
    """Return the distance of two sets of polygons, at most `limit`, mm; minus the width of an overlap."""
    overlap = max((_width(piece) for piece in (one ^ other).decompose()), default=0.0)
    if overlap > TOLERANCE or limit <= 0.0:
        return -overlap
    edges, other_edges = _near(edges, other_edges, limit), _near(other_edges, edges, limit)
    return min(limit, _from_ends(edges, other_edges), _from_ends(other_edges, edges))


def _width(polygons: "CrossSection") -> float:
    """Return twice the area over the perimeter, mm: the width of a thin strip."""
    edges = _edges(polygons)
    perimeter = float(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum())
    return 2.0 * polygons.area() / perimeter if perimeter > 0.0 else 0.0


def _near(edges: Floats, others: Floats, limit: float) -> Floats:
    """Return the edges of which the box is near that of others."""
    if not len(others):
        return edges[:0]
    lo, hi = others.min(axis=(0, 1)) - limit, others.max(axis=(0, 1)) + limit
    within = (edges.min(axis=1) <= hi).all(axis=1) & (edges.max(axis=1) >= lo).all(axis=1)
    return np.asarray(edges[within])


def _from_ends(edges: Floats, others: Floats) -> float:
    """Return the least distance of first ends of edges to other edges, mm."""
    if not len(edges) or not len(others):
        return np.inf
    start, along = others[:, 0], others[:, 1] - others[:, 0]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    least = np.inf
    points = edges.reshape(-1, 2)
    for first in range(0, len(points), CHUNK):
        away = points[first : first + CHUNK, None] - start
        t = np.clip((away * along).sum(axis=2) / square, 0.0, 1.0)
        least = min(least, float(np.linalg.norm(away - t[:, :, None] * along, axis=2).min()))
    return least
