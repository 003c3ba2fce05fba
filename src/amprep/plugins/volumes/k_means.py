"""Bounding volume of few boxes, by k-means with diagonal directions (thesis 2.3)."""

import numpy as np

from amprep.geometry.bounding.boxes.cells import cells_of
from amprep.geometry.bounding.boxes.fit import seal, shrink
from amprep.geometry.bounding.boxes.k_means import cluster_boxes
from amprep.geometry.bounding.boxes.polygons import polygons_of
from amprep.model.bounding_volume import Boxes
from amprep.model.control import Stop
from amprep.model.part import Part
from amprep.plugins.volumes.params import KMeansParams


def k_means_boxes(
    part: Part,
    *,
    params: KMeansParams,
    rng: np.random.Generator,
    stop: Stop,  # noqa: ARG001
) -> Boxes:
    """Return boxes that contain the part: around clusters of its surface, each shrunk to what only it must cover."""
    mesh = part.mesh
    items = cells_of(mesh.vertices, mesh.triangles, params.cells).items
    _, boxes = cluster_boxes(items, params.boxes, params.restarts, rng)
    polygons = polygons_of(mesh.vertices, mesh.triangles)
    boxes = seal(shrink(polygons, boxes), np.concatenate(mesh.bounds))
    return Boxes(boxes[:, :3], boxes[:, 3:])
