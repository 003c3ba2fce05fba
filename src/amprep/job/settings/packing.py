"""Packing settings of a job."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from amprep.errors import JobError
from amprep.model.packing import Interlocking, Objective
from amprep.model.rotations import ORIENT, parse_rotations
from amprep.validation import LARGEST_LENGTH, require, require_bounds

Effort = Literal["fast", "normal", "thorough"]
"""How long packers work; each packer states its budgets."""


@dataclass(frozen=True)
class PackingSettings:
    """The section ``[packing]`` of the job file.

    Attributes
    ----------
    even_layers
        Whether parts are moved vertically, so that the cross-sections of layers become more equal.
    volumes
        Name of a volume maker, or names of several, each of which works on the result of the one before; None leaves
        the choice to the packer.
    rotations
        Allowed rotations of parts that state none, as in a ``[[part]]`` entry; None allows none.
    blade_angle_deg
        Least angle between long straight edges of a part and the recoater blade, if the part may be turned; 0 allows
        every angle.
    blade_edge_mm
        Length from which edges count for it.
    effort
        How long the packer works; `params` take precedence over the budgets of the level.
    params
        Parameters of the packer.
    volume_params
        Parameters of volume makers by name.
    """

    strategy: str = "auto"
    volumes: str | tuple[str, ...] | None = None
    objective: Objective = "builds"
    clearance_mm: float = 2.0
    lift_mm: float = 0.0
    stacking: bool = False
    interlocking: Interlocking = "allow"
    even_layers: bool = False
    rotations: str | None = None
    blade_angle_deg: float = 0.0
    blade_edge_mm: float = 10.0
    effort: Effort = "normal"
    time_limit_s: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    volume_params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_bounds(self, "clearance_mm", "lift_mm", at_least=0)
        require_bounds(self, "clearance_mm", "lift_mm", at_most=LARGEST_LENGTH)
        require_bounds(self, "blade_angle_deg", at_least=0, at_most=45)
        require_bounds(self, "time_limit_s", "blade_edge_mm", above=0)
        require(
            self.stacking or not self.even_layers,
            "even_layers = true must come with stacking = true",
            "stacking = false",
        )
        if self.rotations is not None and self.rotations != ORIENT:
            try:
                parse_rotations(self.rotations)
            except JobError as error:
                raise ValueError(str(error)) from error
        require(self.volumes != (), "volumes must name at least one volume maker", "none")
        for name, table in self.volume_params.items():
            require(
                isinstance(table, Mapping),
                "volume_params must hold one table per volume maker",
                {name: table},
            )


def as_names(volumes: str | tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of a setting ``volumes``, which may be a single name."""
    return (volumes,) if isinstance(volumes, str) else volumes
