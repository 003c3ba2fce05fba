"""Measure mass, scanned area, contacts and trapped powder of supports."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from amprep.geometry.powder.cavities import find_cavities
from amprep.geometry.powder.pockets import Pocket, find_pockets, spacing_for
from amprep.geometry.supports.contact_area import measure_contact
from amprep.model import Build, SupportBody

_MOST_AT_ONCE = 4
"""Largest number of bodies measured at the same time, because each needs memory."""


@dataclass(frozen=True)
class RemovalRules:
    """Settings of the measurement.

    Attributes
    ----------
    layer_mm
        Layer height of the printer.
    densities
        Density (g/cm3) of the supports of each part; None if it is unknown. Empty if none is known.
    hole_mm
        Diameter of a ball that must be able to escape; otherwise powder is trapped.
    thorough
        Whether contacts and powder are measured too.
    """

    layer_mm: float = 0.04
    densities: tuple[float | None, ...] = ()
    hole_mm: float = 0.2
    thorough: bool = False


@dataclass(frozen=True)
class Removal:
    """The figures of one support body.

    Attributes
    ----------
    mass_g
        Mass; None if the density is unknown.
    scan_mm2
        Sum of the cross-sections in all printed layers: volume over layer height.
    contact_mm2, contacts
        Area of the surfaces of parts inside the body, and number of its patches; None if not measured.
    pockets
        Pockets of trapped powder, largest first; None if not measured.
    resolution_mm
        Resolution at which escape channels are measured.
    cavities
        Closed cavities in which there is none of the pockets, largest first; they are always measured.
    """

    mass_g: float | None
    scan_mm2: float
    contact_mm2: float | None = None
    contacts: int | None = None
    pockets: tuple[Pocket, ...] | None = None
    resolution_mm: float | None = None
    cavities: tuple[Pocket, ...] = ()

    @property
    def trapped_mm3(self) -> float | None:
        """Volume of the trapped powder."""
        return None if self.pockets is None else sum(pocket.volume for pocket in self.pockets)


def measure_removal(build: Build, rules: RemovalRules) -> tuple[Removal, ...]:
    """Return the figures of each support body of a build; walls without thickness have no mass.

    Bodies are measured in parallel, one thread per processor.
    """
    with ThreadPoolExecutor(min(os.cpu_count() or 1, _MOST_AT_ONCE)) as pool:
        return tuple(pool.map(lambda body: _removal(build, body, rules), build.supports))


def totals(removal: tuple[Removal, ...]) -> dict[str, float | None]:
    """Return the sums over all bodies by name; None where the figure of a body is unknown."""
    names = ("mass_g", "scan_mm2", "contact_mm2", "contacts", "trapped_mm3")
    return {name: _sum([getattr(each, name) for each in removal]) for name in names}


def _sum(values: list[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) if len(known) == len(values) else None


def _removal(build: Build, body: SupportBody, rules: RemovalRules) -> Removal:
    volume = 0.0 if body.surface else abs(body.mesh.signed_volume)
    density = next(filter(None, (rules.densities[index] for index in body.parts if rules.densities)), None)
    mass = None if density is None else volume * density / 1000.0
    scan = volume / rules.layer_mm
    if body.surface:
        return Removal(mass, scan)
    solid = body.mesh.arrays
    if not rules.thorough:
        return Removal(mass, scan, cavities=tuple(find_cavities(solid)))
    held = [build.parts[index].mesh.arrays for index in body.parts]
    contacts = [measure_contact(solid, part) for part in held]
    pockets = tuple(find_pockets([solid], held, rules.hole_mm))
    low, high = body.mesh.bounds
    return Removal(
        mass,
        scan,
        sum(contact.area for contact in contacts),
        sum(contact.patches for contact in contacts),
        pockets,
        spacing_for(rules.hole_mm, high - low),
        tuple(find_cavities(solid, pockets)),
    )
