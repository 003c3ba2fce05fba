"""Support settings of a job."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from amprep.model.build import SupportsAs
from amprep.supports.rules import PlanningRules
from amprep.validation import LARGEST_LENGTH, LEAST_REACH, require_bounds


@dataclass(frozen=True)
class SupportSettings(PlanningRules):
    """The section `[supports]`: the planning rules, the router, and how supports are written.

    Attributes
    ----------
    enabled
        Whether `amprep run` plans supports.
    strategy, params
        Name of the support router, and its parameters.
    reach_mm
        Largest distance of a supported overhang from a contact; None for 1.5 times the pitch.
    write_as
        Type that a generic file gives to solid supports.
    time_limit_s
        Time after which the router returns its best plan so far.
    """

    enabled: bool = True
    strategy: str = "shortest-paths"
    reach_mm: float | None = None
    write_as: SupportsAs = "support"
    time_limit_s: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_bounds(self, "time_limit_s", above=0)
        require_bounds(self, "reach_mm", at_least=LEAST_REACH, at_most=LARGEST_LENGTH)
        require_bounds(self, "gap_mm", at_most=LARGEST_LENGTH)
