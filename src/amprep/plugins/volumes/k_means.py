"""Bounding volume of few boxes, by k-means with diagonal directions (thesis 2.3)."""

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.bounding.boxes.cells import cells_of
from amprep.geometry.bounding.boxes.fit import merged, seal, shrink
from amprep.geometry.bounding.boxes.k_means import cluster_boxes
from amprep.geometry.bounding.boxes.polygons import polygons_of
from amprep.geometry.bounding.boxes.turned_k_means import turned_clusters
from amprep.model.bounding_volume import Boxes, TurnedVolume
from amprep.model.control import Stop
from amprep.model.part import Part
from amprep.plugins.volumes.params import KMeansParams


def k_means_boxes(
    part: Part,
    *,
    params: KMeansParams,
    rng: np.random.Generator,
    stop: Stop,  # noqa: ARG001
) -> Boxes | TurnedVolume:
    """Return boxes that contain the part: around clusters of its surface, each shrunk to what only it must cover.

    A part that may be rotated about z, or freely, is rotated to the best common orientation of its clusters.
    """
    rotation, boxes = _clustered(part, params, rng)
    turned = part.mesh.vertices @ rotation.T
    polygons = polygons_of(turned, part.mesh.triangles)
    boxes = seal(merged(polygons, shrink(polygons, boxes)))
    volume = Boxes(boxes[:, :3], boxes[:, 3:])
    return volume if (rotation == np.eye(3)).all() else TurnedVolume(volume, rotation)


def _clustered(part: Part, params: KMeansParams, rng: np.random.Generator) -> tuple[Floats, Floats]:
    mesh, freedom = part.mesh, part.orientations.freedom
    if freedom == "list" or not params.rotate:
        items = cells_of(mesh.vertices, mesh.triangles, params.cells).items
        return np.eye(3), cluster_boxes(items, params.boxes, params.restarts, rng)[1]
    return turned_clusters(
        mesh.vertices,
        mesh.triangles,
        params.boxes,
        cells=params.cells,
        restarts=params.restarts,
        freedom=freedom,
        rng=rng,
    )
