"""Support settings of a job."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from amprep.job.settings.bounds import require_overhang
from amprep.model.build import Grounding, SupportsAs
from amprep.model.supports import LARGEST_COST, Escalation
from amprep.validation import LARGEST_COUNT, require


@dataclass(frozen=True)
class SupportSettings:
    """How supports are planned; `pitch_mm` and `reach_mm` of None are chosen by the planner."""

    enabled: bool = True
    strategy: str = "shortest-paths"
    overhang_angle_deg: float = 45.0
    strut_angle_deg: float = 45.0
    pitch_mm: float | None = None
    capacity: int = 0
    node_capacity: int = 0
    load_area_mm2: float = 0.0
    load_height_mm: float = 0.0
    escalation: Escalation = "cut"
    vertical_cost: int = 1
    oblique_cost: int = 2
    share_between_parts: Literal["avoid", "allow"] = "avoid"
    join_columns: bool = False
    slender: float = 8.0
    least_area_mm2: float = 0.5
    least_length_mm: float = 0.5
    reach_mm: float | None = None
    gap_mm: float = 0.0
    grounding: Grounding = "plate"
    write_as: SupportsAs = "support"
    memory_mb: int = 2000
    time_limit_s: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_overhang(self.overhang_angle_deg)
        require(
            10 <= self.strut_angle_deg <= 80, "strut_angle_deg is between 10 and 80", self.strut_angle_deg
        )
        for name in ("pitch_mm", "reach_mm", "time_limit_s"):
            value = getattr(self, name)
            require(value is None or value > 0, f"{name} is above 0", value)
        require(self.slender >= 1, "slender is at least 1", self.slender)
        for name in ("least_area_mm2", "least_length_mm", "gap_mm", "load_area_mm2", "load_height_mm"):
            require(getattr(self, name) >= 0, f"{name} is at least 0", getattr(self, name))
        for name, low in (("memory_mb", 1), ("capacity", 0), ("node_capacity", 0)):
            value = getattr(self, name)
            require(low <= value <= LARGEST_COUNT, f"{name} is between {low} and {LARGEST_COUNT}", value)
        for name in ("vertical_cost", "oblique_cost"):
            value = getattr(self, name)
            require(1 <= value <= LARGEST_COST, f"{name} is between 1 and {LARGEST_COST}", value)
