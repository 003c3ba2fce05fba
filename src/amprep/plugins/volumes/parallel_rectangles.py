"""Bounding volume of two upright boxes over parallel rectangles of any orientation (thesis 2.3, after Saha and Das)."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.boxes.fit import enlarged, seal, shrink
from amprep.geometry.bounding.boxes.orientation import about_z
from amprep.geometry.bounding.boxes.parallel_rectangles import best_angles, planar_items, rectangles_at
from amprep.geometry.bounding.boxes.polygons import enclosing, polygons_of
from amprep.geometry.bounding.boxes.two_boxes import Objective, TwoBoxSearch
from amprep.geometry.bounding.boxes.union import union_volume, volumes
from amprep.model.bounding_volume import Boxes, TurnedVolume
from amprep.model.control import Stop
from amprep.model.mesh import Mesh
from amprep.model.part import Part
from amprep.plugins.volumes.params import TwoRectanglesParams

_ANGLES = 2
"""Angles of each kind at which boxes are fitted to the triangles."""


def two_rectangles(
    part: Part,
    *,
    params: TwoRectanglesParams,
    rng: np.random.Generator,  # noqa: ARG001
    stop: Stop,
) -> Boxes | TurnedVolume:
    """Return two boxes over two parallel rectangles, each as high as what it covers.

    A part that may be rotated about z, or freely, is rotated about z so that the rectangles are along the axes. Any
    other part is tried in all its orientations.
    """
    objective: Objective = "larger" if params.objective == "larger" else "union"
    boxes, rotation = min(
        (_fitted(part.mesh, rotation, objective, stop) for rotation in _rotations(part, objective)),
        key=lambda made: union_volume(made[0]) if objective == "union" else float(volumes(made[0]).max()),
    )
    volume = Boxes(boxes[:, :3], boxes[:, 3:])
    return volume if (rotation == np.eye(3)).all() else TurnedVolume(volume, rotation)


def _rotations(part: Part, objective: Objective) -> list[Floats]:
    if part.orientations.freedom == "list":
        return list(part.orientations.matrices)
    items = planar_items(part.mesh.vertices, part.mesh.triangles)
    angles = best_angles(items, part.mesh.vertices[:, :2], objective, _ANGLES)
    return [np.eye(3), *(about_z(angle) for angle in angles)]


def _fitted(mesh: Mesh, rotation: Floats, objective: Objective, stop: Stop) -> tuple[Floats, Floats]:
    """Return boxes around the mesh after a rotation, and the rotation."""
    vertices = mesh.vertices @ rotation.T
    polygons = polygons_of(vertices, mesh.triangles)
    bounds = enclosing(polygons.points)
    boxes = bounds[None]
    if not stop():
        rectangles, _ = rectangles_at(
            planar_items(vertices, mesh.triangles), 0.0, TwoBoxSearch(objective, planes=40)
        )
        low, high = np.full(len(rectangles), bounds[2]), np.full(len(rectangles), bounds[5])
        boxes = np.column_stack((rectangles[:, :2], low, rectangles[:, 2:], high))
        if objective == "union":  # the lower box then ends at the higher one
            boxes = enlarged(boxes, range(len(boxes)))
    return seal(shrink(polygons, boxes)), rotation
