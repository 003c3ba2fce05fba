"""Cell settings of a job."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from amprep.model.contacts import Base, BaseKind, Connector, ConnectorKind
from amprep.validation import require

LEAST_TIP = 0.05
"""mm; teeth, points, necks and windows finer than that are refused: nothing prints them."""

LARGEST_BASE = 50.0
"""mm; no flange or raft is wider or higher."""

_PATH_OF_CELL = re.compile(r"[/\\]|\.(toml|3mf|stl|obj|ply|off|glb|step|stp)$", re.IGNORECASE)


@dataclass(frozen=True)
class CellSettings:
    """Which lattice cell replaces the edges, and how supports end at the part.

    Attributes
    ----------
    strategy
        Name of a lattice cell, or the path of a file that declares one: TOML, or a mesh.
    connector
        Kind of the connectors; `ending` says what the measures that follow it mean.
    base
        What supports stand on at the plate; `footing` says what the measures that follow it mean.
    lattice
        Struts as beams or as meshes; None leaves it to the cell's parameters.
    removability
        Whether contacts with the parts and powder locked in are measured for the report.
    powder_hole_mm
        Powder counts as locked in where a ball of this diameter cannot leave.
    layer_mm, density_g_cm3
        Thickness of a printed layer, and density of the supports, by which time and mass are estimated; None
        takes the density from the parts' material.
    """

    strategy: str = "x-wall"
    connector: ConnectorKind = "full"
    overlap_mm: float = 0.1
    tooth_pitch_mm: float | None = None
    tooth_width_mm: float = 0.5
    tooth_height_mm: float = 0.8
    point_pitch_mm: float | None = None
    point_mm: float = 0.5
    point_height_mm: float = 1.0
    neck_mm: float = 0.0
    neck_height_mm: float = 0.3
    window_mm: float = 0.0
    base: BaseKind = "direct"
    flange_mm: float = 1.0
    flange_height_mm: float = 0.6
    raft_margin_mm: float = 2.0
    raft_height_mm: float = 0.6
    raft_hole_mm: float = 0.0
    lattice: Literal["beams", "mesh"] | None = None
    removability: bool = False
    powder_hole_mm: float = 0.2
    layer_mm: float = 0.04
    density_g_cm3: float | None = None
    params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require(self.overlap_mm >= 0, "overlap_mm is at least 0", self.overlap_mm)
        self._require_ending()
        require(self.powder_hole_mm >= 0.02, "powder_hole_mm is at least 0.02", self.powder_hole_mm)
        require(self.layer_mm > 0, "layer_mm is above 0", self.layer_mm)
        density = self.density_g_cm3
        require(density is None or density > 0, "density_g_cm3 is above 0", density)

    def _require_ending(self) -> None:
        for name in ("tooth_width_mm", "tooth_height_mm", "point_mm", "point_height_mm", "neck_height_mm"):
            require(getattr(self, name) >= LEAST_TIP, f"{name} is at least {LEAST_TIP}", getattr(self, name))
        for name, width in (("tooth_pitch_mm", self.tooth_width_mm), ("point_pitch_mm", self.point_mm)):
            pitch = getattr(self, name)
            require(pitch is None or pitch > width, f"{name} is above the width, {width:g}", pitch)
        for name in ("flange_mm", "flange_height_mm", "raft_margin_mm", "raft_height_mm"):
            value = getattr(self, name)
            require(LEAST_TIP <= value <= LARGEST_BASE, f"{name} is {LEAST_TIP} to {LARGEST_BASE}", value)
        for name in ("neck_mm", "window_mm", "raft_hole_mm"):
            value = getattr(self, name)
            require(value == 0 or value >= LEAST_TIP, f"{name} is 0 or at least {LEAST_TIP}", value)
        cut = self.neck_mm > 0 or self.window_mm > 0
        require(
            self.connector != "extend" or not cut,
            "neck_mm and window_mm are for connectors 'full', 'teeth' and 'point'",
            repr(self.connector),
        )
        if self.neck_mm > 0 and self.connector in ("teeth", "point"):
            width, height = self.ending.width, self.ending.height
            require(self.neck_mm < width, f"neck_mm is below the width of {width:g}", self.neck_mm)
            require(
                self.neck_height_mm < height,
                f"neck_height_mm is below the height of {height:g}",
                self.neck_height_mm,
            )

    @property
    def ending(self) -> Connector:
        """The connectors asked for."""
        sizes = (self.tooth_pitch_mm, self.tooth_width_mm, self.tooth_height_mm)
        if self.connector == "point":
            sizes = (self.point_pitch_mm, self.point_mm, self.point_height_mm)
        return Connector(self.connector, *sizes, self.neck_mm, self.neck_height_mm, self.window_mm)

    @property
    def footing(self) -> Base:
        """What supports stand on at the plate."""
        if self.base == "raft":
            return Base("raft", self.raft_margin_mm, self.raft_height_mm, self.raft_hole_mm)
        return Base(self.base, self.flange_mm, self.flange_height_mm)

    @property
    def file(self) -> Path | None:
        """The file that declares the cell, or None when `strategy` is a name."""
        return Path(self.strategy) if _PATH_OF_CELL.search(self.strategy) else None
