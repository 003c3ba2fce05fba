"""Packing settings of a job."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from amprep.model.packing import Objective
from amprep.validation import require


@dataclass(frozen=True)
class PackingSettings:
    """How the parts are packed.

    Attributes
    ----------
    volumes
        Name of the volume maker.
    volume_params, params
        Parameters of the volume maker and of the packer.
    """

    strategy: str = "extreme-points"
    volumes: str = "box"
    objective: Objective = "builds"
    clearance_mm: float = 2.0
    lift_mm: float = 0.0
    stacking: bool = False
    time_limit_s: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    volume_params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require(self.clearance_mm >= 0, "clearance_mm is at least 0", self.clearance_mm)
        require(self.lift_mm >= 0, "lift_mm is at least 0", self.lift_mm)
        require(
            self.time_limit_s is None or self.time_limit_s > 0, "time_limit_s is above 0", self.time_limit_s
        )
