"""The settings of a job as frozen records; each checks its own bounds, once."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.errors import JobError
from amprep.model.build import Grounding, SupportsAs, Target
from amprep.model.contacts import Base, BaseKind, Connector, ConnectorKind
from amprep.model.packing import Objective
from amprep.model.part import Orientations
from amprep.model.rotations import parse_rotations
from amprep.model.supports import LARGEST_COST, Escalation
from amprep.printers.catalogue import Printer
from amprep.validation import require

LEAST_TIP = 0.05
"""mm; teeth, points, necks and windows finer than that are refused: nothing prints them."""

LARGEST_BASE = 50.0
"""mm; no flange or raft is wider or higher."""

LARGEST_COUNT = 1_000_000
"""Bound on quantities, capacities and costs: sums of them stay far inside 64 bits."""

_PATH_OF_CELL = re.compile(r"[/\\]|\.(toml|3mf|stl|obj|ply|off|glb|step|stp)$", re.IGNORECASE)

Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
Box = tuple[float, float, float, float, float, float]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class InputSpec:
    """A file or folder to read, and how often each of its parts is wanted; None keeps what the file says."""

    path: Path
    quantity: int | None = None

    def __post_init__(self) -> None:
        _require_quantity(self.quantity)


@dataclass(frozen=True)
class ReadingSettings:
    """Which reader reads which suffix, and the readers' parameters by name."""

    readers: Mapping[str, Any] = field(default_factory=dict)
    params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for suffix, name in self.readers.items():
            valid = suffix.startswith(".") and suffix == suffix.lower() and isinstance(name, str)
            require(valid, "readers maps a lower-case suffix with its dot to a reader's name", {suffix: name})
        for name, table in self.params.items():
            require(isinstance(table, Mapping), "params holds one table per reader", {name: table})


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
        _require_overhang(self.overhang_angle_deg)
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


@dataclass(frozen=True)
class PartSettings:
    """What a ``[[part]]`` entry says about the parts of one file or name; None keeps what was read."""

    file: str | None = None
    name: str | None = None
    quantity: int | None = None
    value: float | None = None
    rotations: str | tuple[Matrix, ...] | None = None
    boxes: tuple[Box, ...] | None = None
    fixed: tuple[Point, ...] = ()
    supports: bool | None = None
    overhang_angle_deg: float | None = None
    blockers: tuple[str, ...] = ()
    enforcers: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for file in (*self.blockers, *self.enforcers):
            require(bool(file) and "\0" not in file, "blockers and enforcers are paths", repr(file))
        require(bool(self.file or self.name), "a part is named by file or name", "neither")
        require("\0" not in (self.file or ""), "file is a path", repr(self.file))
        _require_quantity(self.quantity)
        require(self.value is None or self.value >= 0, "value is at least 0", self.value)
        if self.overhang_angle_deg is not None:
            _require_overhang(self.overhang_angle_deg)
        self._require_boxes()
        try:
            self.orientations  # noqa: B018 reading the property checks the rotations
        except JobError as error:
            raise ValueError(str(error)) from error

    @property
    def orientations(self) -> Orientations | None:
        """The rotations allowed, or None."""
        if self.rotations is None or isinstance(self.rotations, str):
            return None if self.rotations is None else parse_rotations(self.rotations)
        return parse_rotations([[list(row) for row in matrix] for matrix in self.rotations])

    @property
    def box_array(self) -> Floats | None:
        """The boxes as ``(k, 6)`` mm, or None."""
        return None if self.boxes is None else frozen(self.boxes, np.float64, 6)

    def _require_boxes(self) -> None:
        require(self.boxes is None or len(self.boxes) > 0, "boxes holds at least one box", "none")
        for box in self.boxes or ():
            ordered = all(lo < hi for lo, hi in zip(box[:3], box[3:], strict=True))
            require(ordered, "boxes are x0, y0, z0, x1, y1, z1 with each 0 below its 1", list(box))


@dataclass(frozen=True, eq=False)
class Job:
    """Everything `amprep run` is asked to do.

    Attributes
    ----------
    name
        Stem of the job file or of the first input; outputs are named after it.
    folder
        Folder of the job file, where its relative paths start; None without a job file.
    table
        The keys as they were given; `amprep.job.override` and `apply_sets` make a new job from it.
    """

    name: str
    inputs: tuple[InputSpec, ...]
    printer: Printer
    folder: Path | None = None
    seed: int = 0
    target: Target = "generic"
    reading: ReadingSettings = field(default_factory=ReadingSettings)
    packing: PackingSettings = field(default_factory=PackingSettings)
    supports: SupportSettings = field(default_factory=SupportSettings)
    cells: CellSettings = field(default_factory=CellSettings)
    parts: tuple[PartSettings, ...] = ()
    source: str = "job"
    table: Mapping[str, Any] = field(default_factory=dict)

    @property
    def printer_is_default(self) -> bool:
        """Whether nobody chose the printer; then the user is told which one it is."""
        return "printer" not in self.table


def _require_quantity(quantity: int | None) -> None:
    valid = quantity is None or 1 <= quantity <= LARGEST_COUNT
    require(valid, f"quantity is between 1 and {LARGEST_COUNT}", quantity)


def _require_overhang(angle: float) -> None:
    require(0 <= angle <= 89, "overhang_angle_deg is between 0 and 89", angle)
