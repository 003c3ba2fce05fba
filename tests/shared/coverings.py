"""Brute force for coverings with boxes, and solids made of boxes."""

from itertools import product

import numpy as np
from manifold3d import Manifold

from amprep.geometry.bounding.boxes.polygons import ConvexPolygons, polygons_of
from amprep.model import Mesh, Part


def box_of(points):
    return np.concatenate((points.min(axis=0), points.max(axis=0)))


def boxes_volume(boxes):
    """Volume of a union of boxes, by inclusion and exclusion."""
    total = 0.0
    for chosen in product((0, 1), repeat=len(boxes)):
        if any(chosen):
            picked = np.array([box for box, on in zip(boxes, chosen, strict=True) if on])
            sides = picked[:, 3:].min(axis=0) - picked[:, :3].max(axis=0)
            total += -((-1) ** sum(chosen)) * float(np.prod(np.maximum(sides, 0)))
    return total


def as_points(points):
    """Return points as polygons of one corner each."""
    count = len(points)
    return ConvexPolygons(np.array(points, float), np.arange(count), np.arange(count + 1))


def best_partition(groups, objective):
    """Return the least objective of two boxes over all ways to put whole groups of points into one or the other."""
    best = np.inf
    for chosen in product((0, 1), repeat=len(groups) - 1):
        sides = [[g for g, on in zip(groups, (0, *chosen), strict=True) if on == side] for side in (0, 1)]
        boxes = [box_of(np.concatenate(side)) for side in sides if side]
        volume = max(boxes_volume([b]) for b in boxes) if objective == "larger" else boxes_volume(boxes)
        best = min(best, volume)
    return best


def solid_of(boxes, name="part"):
    """Return a part that is the union of boxes ``x0 y0 z0 x1 y1 z1``."""
    solid = Manifold()
    for box in np.array(boxes, float):
        solid += Manifold.cube(list(box[3:] - box[:3])).translate(list(box[:3]))
    return part_of(solid, name)


def part_of(solid, name="part"):
    mesh = solid.to_mesh64()
    return Part(name, Mesh(mesh.vert_properties[:, :3], mesh.tri_verts), solid.volume())


def polygons_of_part(part):
    return polygons_of(part.mesh.vertices, part.mesh.triangles)


def dense_points(part, steps=12):
    """Points on each triangle of a part, the corners included."""
    weights = (
        np.array([(i, j, steps - i - j) for i in range(steps + 1) for j in range(steps + 1 - i)]) / steps
    )
    return np.einsum("wk,tkc->twc", weights, part.mesh.vertices[part.mesh.triangles]).reshape(-1, 3)


def in_some_box(points, boxes, tolerance=1e-9):
    inside = np.zeros(len(points), bool)
    for box in boxes:
        inside |= ((points >= box[:3] - tolerance) & (points <= box[3:] + tolerance)).all(axis=1)
    return inside
