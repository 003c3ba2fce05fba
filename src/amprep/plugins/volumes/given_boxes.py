"""Bounding volumes of boxes: the enclosing box, and boxes given in the job."""

import numpy as np

from amprep.checks.volumes import check_volume
from amprep.errors import JobError
from amprep.model.bounding_volume import Boxes
from amprep.model.part import Part


def enclosing_box(part: Part) -> Boxes:
    """Return the enclosing box of the part."""
    least, most = part.mesh.bounds
    return Boxes(least[None], most[None])


def given_boxes(part: Part) -> Boxes:
    """Return the boxes given in the job for the part.

    Raises
    ------
    JobError
        If there are none, if a box is empty, or if their union does not contain the part.
    """
    if part.boxes is None or not np.size(part.boxes):
        raise JobError(
            f"part {part.name!r}: the volume maker 'boxes' needs boxes = [[x0, y0, z0, x1, y1, z1], ...] in "
            "the job's [[part]], found none; add them or choose the volume maker 'box'"
        )
    corners = np.asarray(part.boxes, dtype=np.float64).reshape(-1, 6)
    for number, corner in enumerate(corners.tolist(), start=1):
        if not (np.isfinite(corner).all() and all(corner[i] < corner[i + 3] for i in range(3))):
            raise JobError(
                f"part {part.name!r}: box {number} must be x0 < x1, y0 < y1, z0 < z1 in mm, got {corner}"
            )
    boxes = Boxes(corners[:, :3], corners[:, 3:])
    violations = check_volume(part, boxes)
    if violations:
        raise JobError(f"part {part.name!r}: {violations[0].message}; enlarge the boxes or add one")
    return boxes
