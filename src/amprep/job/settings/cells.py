"""Settings of the job's section ``[cells]``."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from amprep.model.contacts import BaseRules, ConnectorRules
from amprep.validation import LARGEST_OVERLAP, require_bounds

_PATH_OF_CELL = re.compile(r"[/\\]|\.(toml|3mf|stl|obj|ply|off|glb|step|stp)$", re.IGNORECASE)


@dataclass(frozen=True)
class CellSettings(ConnectorRules, BaseRules):
    """The lattice cell that replaces the edges, the connectors at the part, and the bases on the plate.

    Attributes
    ----------
    strategy
        Name of a lattice cell, or the path of a file that declares one: TOML, or a mesh.
    overlap_mm
        Depth to which connectors enter the part that they hold.
    lattice
        Whether struts become beams or meshes; None leaves the choice to the parameters of the cell.
    removability
        Whether contact areas and trapped powder are measured for the report.
    powder_hole_mm
        Diameter of a ball that must be able to leave a cavity; otherwise its powder counts as trapped.
    density_g_cm3
        Density of the supports, for their mass; without it that of the part's material is used, or of the profile.
    """

    strategy: str = "x-wall"
    overlap_mm: float = 0.1
    lattice: Literal["beams", "mesh"] | None = None
    removability: bool = False
    powder_hole_mm: float = 0.2
    density_g_cm3: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        ConnectorRules.__post_init__(self)
        BaseRules.__post_init__(self)
        require_bounds(self, "overlap_mm", at_least=0)
        require_bounds(self, "overlap_mm", at_most=LARGEST_OVERLAP)
        require_bounds(self, "powder_hole_mm", at_least=0.02)
        require_bounds(self, "density_g_cm3", above=0)

    @property
    def file(self) -> Path | None:
        """The file that declares the cell, or None when `strategy` is a name."""
        return Path(self.strategy) if _PATH_OF_CELL.search(self.strategy) else None
