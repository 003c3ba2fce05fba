"""Bounding volume of two axis-parallel boxes (thesis 2.3, after Bespamyatnikh and Segal)."""

import numpy as np

from amprep.geometry.bounding.boxes.fit import seal, shrink
from amprep.geometry.bounding.boxes.polygons import polygons_of
from amprep.geometry.bounding.boxes.two_boxes import TwoBoxSearch, flat_coordinates, two_boxes
from amprep.model.bounding_volume import Boxes
from amprep.model.control import Stop
from amprep.model.part import Part
from amprep.plugins.volumes.params import TwoBoxesParams


def cover_with_two(
    part: Part,
    *,
    params: TwoBoxesParams,
    rng: np.random.Generator,  # noqa: ARG001
    stop: Stop,  # noqa: ARG001
) -> Boxes:
    """Return two boxes that contain the part, or one where a second does not help.

    The union of two boxes has no cavity, so boxes that contain the surface contain the interior.
    """
    polygons = polygons_of(part.mesh.vertices, part.mesh.triangles)
    search = TwoBoxSearch(
        objective="larger" if params.objective == "larger" else "union", planes=params.planes
    )
    flat = flat_coordinates(part.mesh.vertices, part.mesh.triangles)
    boxes, _ = two_boxes(polygons, search, preferred=flat)
    sealed = seal(shrink(polygons, boxes))
    return Boxes(sealed[:, :3], sealed[:, 3:])
