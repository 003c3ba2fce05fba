"""The record of a job: inputs, printer and settings."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from amprep.job.settings.bounds import require_quantity
from amprep.job.settings.cells import CellSettings
from amprep.job.settings.packing import PackingSettings
from amprep.job.settings.parts import PartSettings
from amprep.job.settings.rules import RuleSettings
from amprep.job.settings.supports import SupportSettings
from amprep.materials.profile import MaterialProfile
from amprep.model.build import Target
from amprep.printers.catalogue import Printer
from amprep.units import MILLIMETRES
from amprep.validation import require


@dataclass(frozen=True)
class InputSpec:
    """A file or folder to read, and the number of copies of each part; None keeps the number in the file."""

    path: Path
    quantity: int | None = None

    def __post_init__(self) -> None:
        require_quantity(self.quantity)


@dataclass(frozen=True)
class ReadingSettings:
    """How files are read.

    Attributes
    ----------
    readers
        Names of readers by suffix.
    params
        Parameters of readers by name.
    strict
        Whether files that break any rule of their format are refused.
    unit
        Unit of files whose format does not state one.
    """

    strict: bool = False
    unit: str = "millimetre"
    readers: Mapping[str, Any] = field(default_factory=dict)
    params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require(self.unit in MILLIMETRES, f"unit must be one of {', '.join(MILLIMETRES)}", self.unit)
        for suffix, name in self.readers.items():
            valid = suffix.startswith(".") and suffix == suffix.lower() and isinstance(name, str)
            require(valid, "readers must map suffixes such as '.stl' to names of readers", {suffix: name})
        for name, table in self.params.items():
            require(isinstance(table, Mapping), "params must hold one table per reader", {name: table})

    @property
    def shared(self) -> Mapping[str, Any]:
        """Parameters of every reader that has them; `params` take precedence."""
        return {"strict": self.strict, "unit": self.unit}


@dataclass(frozen=True, eq=False)
class Job:
    """A job: the parts to print, the printer and the rules.

    Attributes
    ----------
    name
        What the job states, or the stem of its file, of its only input, or the name of the folder of all inputs;
        output files are named after it.
    folder
        Folder of the job file, where relative paths start; None without a job file.
    labels
        The list of labels (.csv); None for none.
    table
        The keys as given, from which `amprep.job.override` and `apply_sets` make a new job.
    """

    name: str
    inputs: tuple[InputSpec, ...]
    printer: Printer
    folder: Path | None = None
    material: MaterialProfile = field(default_factory=MaterialProfile)
    seed: int = 0
    target: Target = "generic"
    reading: ReadingSettings = field(default_factory=ReadingSettings)
    packing: PackingSettings = field(default_factory=PackingSettings)
    supports: SupportSettings = field(default_factory=SupportSettings)
    cells: CellSettings = field(default_factory=CellSettings)
    parts: tuple[PartSettings, ...] = ()
    rules: tuple[RuleSettings, ...] = ()
    labels: Path | None = None
    source: str = "job"
    table: Mapping[str, Any] = field(default_factory=dict)

    def for_rule(self, number: int) -> "Job":
        """Return the job with the settings of a ``[[rule]]`` entry, numbered from 1; 0 is the job itself."""
        if number == 0:
            return self
        rule = self.rules[number - 1]
        return replace(self, cells=rule.cells(self.cells), supports=rule.supports(self.supports))

    @property
    def printer_is_default(self) -> bool:
        """Whether the job names no printer, so that the default printer is used."""
        return "printer" not in self.table

    @property
    def default_distances(self) -> str:
        """Sentence on lift and part distance where the defaults of metal powder beds apply; else empty."""
        words = {"lift_mm": "lift", "clearance_mm": "part distance"}
        defaults = self.printer.packing_defaults
        stated = self.table.get("packing", {})
        found = [
            f"{name} {defaults[key]:g} mm"
            for key, name in words.items()
            if key not in stated and getattr(self.packing, key) == defaults[key]
        ]
        metal = self.printer.technology == "metal-powder-bed"
        return f"{' and '.join(found)} by default for metal powder beds" if metal and found else ""

    def distances_on(self, printer: Printer) -> tuple[float, float]:
        """Return clearance and lift (mm) as the job states them, or else the defaults of another printer."""
        distances = {**printer.packing_defaults, **self.table.get("packing", {})}
        return distances["clearance_mm"], distances["lift_mm"]

    @property
    def beams(self) -> bool | None:
        """Whether struts become beams; None leaves it to the parameters of the cell. Slicers read no beams."""
        if self.target != "generic" or self.cells.lattice == "mesh":
            return False
        return True if self.cells.lattice == "beams" else None
