"""The settings of a job as frozen records; each checks its own bounds, once."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from amprep.job.settings.bounds import require_quantity
from amprep.job.settings.cells import CellSettings
from amprep.job.settings.packing import PackingSettings
from amprep.job.settings.parts import PartSettings
from amprep.job.settings.supports import SupportSettings
from amprep.model.build import Target
from amprep.printers.catalogue import Printer
from amprep.validation import require


@dataclass(frozen=True)
class InputSpec:
    """A file or folder to read, and how often each of its parts is wanted; None keeps what the file says."""

    path: Path
    quantity: int | None = None

    def __post_init__(self) -> None:
        require_quantity(self.quantity)


@dataclass(frozen=True)
class ReadingSettings:
    """Which reader reads which suffix, and the readers' parameters by name."""

    readers: Mapping[str, Any] = field(default_factory=dict)
    params: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for suffix, name in self.readers.items():
            valid = suffix.startswith(".") and suffix == suffix.lower() and isinstance(name, str)
            require(valid, "readers must map suffixes such as '.stl' to names of readers", {suffix: name})
        for name, table in self.params.items():
            require(isinstance(table, Mapping), "params must hold one table per reader", {name: table})


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
