"""Parameters of the mesh readers."""

from dataclasses import dataclass

from amprep.errors import JobError


@dataclass(frozen=True)
class StepParams:
    """How finely curved faces of a STEP file become triangles.

    Attributes
    ----------
    deviation_mm
        Greatest distance of a triangle from the true face, 0.0001 to 10.
    angle_deg
        Greatest angle between neighbouring triangles on a curved face, 1 to 60.
    """

    deviation_mm: float = 0.01
    angle_deg: float = 15.0

    def __post_init__(self) -> None:
        if not 1e-4 <= self.deviation_mm <= 10.0:
            raise JobError(f"deviation_mm: expected 0.0001 to 10, got {self.deviation_mm}")
        if not 1.0 <= self.angle_deg <= 60.0:
            raise JobError(f"angle_deg: expected 1 to 60, got {self.angle_deg}")
