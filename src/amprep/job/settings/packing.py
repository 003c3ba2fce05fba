"""Packing settings of a job."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from amprep.model.packing import Objective
from amprep.validation import require_bounds


@dataclass(frozen=True)
class PackingSettings:
    """The section ``[packing]`` of the job file.

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
        require_bounds(self, "clearance_mm", "lift_mm", at_least=0)
        require_bounds(self, "time_limit_s", above=0)
