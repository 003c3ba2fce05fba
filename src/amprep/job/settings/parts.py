"""Settings of single parts in a job."""

from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.errors import JobError
from amprep.job.settings.bounds import require_quantity
from amprep.model.orientation import OrientationRules
from amprep.model.packing import LARGEST_VALUE
from amprep.model.part import Orientations
from amprep.model.rotations import ORIENT, parse_rotations
from amprep.model.supports.rules import LARGEST_LIMIT
from amprep.validation import require, require_bounds

Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
Box = tuple[float, float, float, float, float, float]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class PartSettings:
    """Settings in a ``[[part]]`` entry, for the parts of one file or name; None keeps the value that was read."""

    file: str | None = None
    name: str | None = None
    quantity: int | None = None
    value: float | None = None
    rotations: str | tuple[Matrix, ...] | None = None
    no_contact: tuple[str, ...] = ()
    face_up: tuple[str, ...] = ()
    face_down: tuple[str, ...] = ()
    tilt_deg: float | None = None
    volumes: str | tuple[str, ...] | None = None
    boxes: tuple[Box, ...] | None = None
    fixed: tuple[Point, ...] = ()
    supports: bool | None = None
    overhang_angle_deg: float | None = None
    territory_margin_mm: float | None = None
    blockers: tuple[str, ...] = ()
    enforcers: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for file in (*self.blockers, *self.enforcers):
            require(bool(file) and "\0" not in file, "blockers and enforcers must be paths", repr(file))
        require(bool(self.file or self.name), "a [[part]] entry must have a file or a name", "neither")
        require("\0" not in (self.file or ""), "file must be a path", repr(self.file))
        require_quantity(self.quantity)
        require_bounds(self, "value", at_least=0, at_most=LARGEST_VALUE)
        require_bounds(self, "overhang_angle_deg", at_least=0, at_most=89)
        require_bounds(self, "territory_margin_mm", at_least=0, at_most=LARGEST_LIMIT)
        self._require_boxes()
        self.orientation_rules  # noqa: B018 reading the property checks the rules
        try:
            self.orientations  # noqa: B018 reading the property checks the rotations
        except JobError as error:
            raise ValueError(str(error)) from error

    @property
    def orientations(self) -> Orientations | None:
        """Allowed orientations, or None."""
        if self.rotations is None or self.rotations == ORIENT:
            return None
        if isinstance(self.rotations, str):
            return parse_rotations(self.rotations)
        return parse_rotations([[list(row) for row in matrix] for matrix in self.rotations])

    @property
    def orientation_rules(self) -> OrientationRules:
        """What restricts the search for orientations."""
        tilt = 180.0 if self.tilt_deg is None else self.tilt_deg
        return OrientationRules(self.no_contact, self.face_up, self.face_down, tilt)

    @property
    def box_array(self) -> Floats | None:
        """The boxes as ``(k, 6)`` mm, or None."""
        return None if self.boxes is None else frozen(self.boxes, np.float64, 6)

    def _require_boxes(self) -> None:
        require(self.volumes != (), "volumes must name at least one volume maker", "none")
        require(
            self.boxes is None or self.volumes in (None, "boxes"),
            "a part with boxes must have no volumes, or volumes = 'boxes'",
            self.volumes,
        )
        require(self.boxes is None or len(self.boxes) > 0, "boxes must have at least one box", "none")
        for box in self.boxes or ():
            ordered = all(lo < hi for lo, hi in zip(box[:3], box[3:], strict=True))
            require(
                ordered, "a box must be [x0, y0, z0, x1, y1, z1] with x0 < x1, y0 < y1 and z0 < z1", list(box)
            )
