"""Find and read printer profiles: built-in ones, those of the project, and those of the user."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from amprep.errors import JobError
from amprep.model.build_volume import BuildVolume
from amprep.profiles import Catalogue, Origin
from amprep.typed import make
from amprep.validation import read_table, require, require_bounds

Technology = Literal["metal-powder-bed", "polymer-powder-bed", "filament"]

DEFAULT_PRINTER = "EOS M290"
SHIPPED = Path(__file__).parent / "profiles"

USUAL_DIRECTIONS: dict[Technology, tuple[float | None, float | None]] = {
    "metal-powder-bed": (0.0, 90.0),
    "polymer-powder-bed": (0.0, None),
    "filament": (None, None),
}
"""Directions (degrees) of recoater and gas where a profile states none: along x, and across it."""


@dataclass(frozen=True)
class PrinterProfile:
    """The keys of a printer profile.

    Attributes
    ----------
    size_mm
        Size of the build volume: x, y, z of a box, or diameter and height of a cylinder.
    zones
        Forbidden zones, each x0, y0, z0, x1, y1, z1 in build coordinates.
    origin_mm
        Corner of the plate in the coordinates of PrusaSlicer, whose origin may lie elsewhere on the bed.
    recoater_deg, gas_flow_deg
        Directions in which the recoater moves and the gas flows, in degrees from x to y; None for what is usual.
    source
        Source of the sizes, e.g. the manufacturer's data sheet.
    """

    size_mm: tuple[float, float, float] | tuple[float, float]
    name: str = ""
    technology: Technology = "metal-powder-bed"
    shape: Literal["box", "cylinder"] = "box"
    zones: tuple[tuple[float, float, float, float, float, float], ...] = ()
    origin_mm: tuple[float, float] = (0.0, 0.0)
    recoater_deg: float | None = None
    gas_flow_deg: float | None = None
    source: str = ""

    def __post_init__(self) -> None:
        require(min(self.size_mm) > 0, "size_mm must be above 0", list(self.size_mm))
        require(max(self.size_mm) <= 10_000, "size_mm must be at most 10000", list(self.size_mm))
        far = max(map(abs, self.origin_mm))
        require(far <= 10_000, "origin_mm must be within 10000 of 0", list(self.origin_mm))
        require_bounds(self, "recoater_deg", "gas_flow_deg", at_least=0, at_most=360)
        expected = "diameter and height" if self.shape == "cylinder" else "x, y and z"
        count = 2 if self.shape == "cylinder" else 3
        require(
            len(self.size_mm) == count, f"size_mm of a {self.shape} must be {expected}", list(self.size_mm)
        )
        for zone in self.zones:
            ordered = all(lo < hi for lo, hi in zip(zone[:3], zone[3:], strict=True))
            require(
                ordered, "zones must be x0, y0, z0, x1, y1, z1 with x0 < x1, y0 < y1, z0 < z1", list(zone)
            )


@dataclass(frozen=True, eq=False)
class Printer:
    """A printer that a job can use.

    Attributes
    ----------
    recoater_deg, gas_flow_deg
        Directions in which the recoater moves and the gas flows, in degrees from x to y; None without one.
    source
        Source of its sizes.
    origin
        Whether the profile is built in, or belongs to the project, the user or the job.
    plate_origin
        Corner of the plate, x and y in mm, in the coordinates of PrusaSlicer.
    """

    name: str
    technology: Technology
    space: BuildVolume
    recoater_deg: float | None = None
    gas_flow_deg: float | None = None
    source: str = ""
    origin: Origin = "built-in"
    plate_origin: tuple[float, float] = (0.0, 0.0)

    @property
    def packing_defaults(self) -> dict[str, Any]:
        """The defaults of the job's section ``[packing]`` that depend on the technology.

        Loose powder of polymers holds parts above one another. Parts of metal are cut off the plate, which takes some
        height, and they are farther from each other because of spatter and of supports beside them.
        """
        metal = {"clearance_mm": 5.0, "lift_mm": 3.0, "blade_angle_deg": 5.0}
        others = {"clearance_mm": 2.0, "lift_mm": 0.0, "blade_angle_deg": 0.0}
        return {"stacking": self.stacks, **(metal if self.technology == "metal-powder-bed" else others)}

    @property
    def stacks(self) -> bool:
        """Default of stacking: whether parts may be above one another."""
        return self.technology == "polymer-powder-bed"

    @property
    def needs_supports(self) -> bool:
        """Default of supports: whether overhangs need them."""
        return self.technology != "polymer-powder-bed"


def find_printer(name: str, folder: Path | None = None, env: Mapping[str, str] = os.environ) -> Printer:
    """Return the printer called `name`, or at this path; see `amprep.profiles.Catalogue.find`."""
    return _catalogue(folder, env).find(name)


def list_printers(
    folder: Path | None = None, env: Mapping[str, str] = os.environ
) -> tuple[list[Printer], list[str]]:
    """Return all printers and warnings; see `amprep.profiles.Catalogue.listed`."""
    return _catalogue(folder, env).listed()


def printer_from_table(table: Mapping[str, Any], where: str, name: str, origin: Origin = "job") -> Printer:
    """Return the printer that a table describes.

    Parameters
    ----------
    table
        The keys of `PrinterProfile`.
    where
        File or section, for messages.
    name
        Used if the table has no name.
    origin
        Where the table comes from.

    Raises
    ------
    JobError
        If a key is unknown or a value is invalid.
    """
    if "size_mm" not in table:
        raise JobError(f"{where}: expected size_mm = [x, y, z], found none")
    profile = make(PrinterProfile, table, where)
    size = profile.size_mm if len(profile.size_mm) == 3 else (profile.size_mm[0], *profile.size_mm)
    zones = np.array(profile.zones).reshape(-1, 6)
    space = BuildVolume(np.array(size), profile.shape, zones[:, :3], zones[:, 3:])
    usual = USUAL_DIRECTIONS[profile.technology]
    recoater, gas = (
        usual[0] if profile.recoater_deg is None else profile.recoater_deg,
        usual[1] if profile.gas_flow_deg is None else profile.gas_flow_deg,
    )
    named = profile.name or name
    return Printer(named, profile.technology, space, recoater, gas, profile.source, origin, profile.origin_mm)


def _catalogue(folder: Path | None, env: Mapping[str, str]) -> Catalogue[Printer]:
    return Catalogue("printer", SHIPPED, _read, folder, env)


def _read(path: Path, origin: Origin) -> Printer:
    return _shipped(path) if origin == "built-in" else _read_own(path, origin)


def _read_own(path: Path, origin: Origin) -> Printer:
    return printer_from_table(read_table(path, "printer"), str(path), path.stem, origin)


@cache
def _shipped(path: Path) -> Printer:
    """Read a built-in profile; the result is cached, because the file does not change."""
    return _read_own(path, "built-in")
