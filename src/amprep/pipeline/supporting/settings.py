"""The rules that travel with a build in its file, from the settings of its job."""

from amprep.job import Job
from amprep.job.planning import planning_table
from amprep.model import (
    BuildSettings,
    Target,
)
from amprep.model.supports.sizes import SupportSizes
from amprep.printers.catalogue import Printer

LARGEST_REACH = 5.0
"""Upper limit (mm) of the default reach: even in a coarse grid, no face farther from a contact counts as held."""


def usual_reach(pitch: float, spacing: float) -> float:
    """Return the reach (mm) of a job that states none: 1.5 pitches, but no more than the contact spacing.

    Contacts at the corners of squares as wide as the spacing are 0.71 spacings from the middle. With the distance
    of sample points that is 0.8 spacings, below which the reach does not fall.
    """
    reach = min(1.5 * pitch, LARGEST_REACH)
    return max(min(reach, spacing), 0.8 * spacing) if spacing else reach


def build_settings(job: Job, build_id: str, pitch: float) -> BuildSettings:
    """Return the rules that travel with the build's file."""
    return BuildSettings(
        build_id=build_id,
        space=job.printer.space,
        target=job.target,
        printer=job.printer.name,
        clearance=job.packing.clearance_mm,
        lift=job.packing.lift_mm,
        overlap=job.cells.overlap_mm,
        reach=job.supports.reach_mm or usual_reach(pitch, job.supports.contact_spacing_mm),
        rules=job.supports,
        supported=job.supports.enabled,
        supports_as=job.supports.write_as,
        sizes=_sizes(job, pitch),
        plate_origin=plate_origin(job.printer, job.target),
        planning=planning_table(job),
    )


def plate_origin(printer: Printer, target: Target) -> tuple[float, float]:
    """Return where files for a target place the corner of the plate of a printer, x and y in mm.

    PrusaSlicer counts from the origin of the machine, other programs from the corner of the plate.
    """
    return printer.plate_origin if target == "prusaslicer" else (0.0, 0.0)


def _sizes(job: Job, pitch: float) -> SupportSizes:
    cells = job.cells
    tips, base = cells.has_tips, cells.base != "direct"
    return SupportSizes(
        square_mm=pitch,
        tip_width_mm=cells.tip_width_mm if tips else 0.0,
        tip_height_mm=cells.tip_height_mm if tips else 0.0,
        neck_mm=cells.neck_mm,
        base_margin_mm=cells.base_margin_mm if base else 0.0,
        base_height_mm=cells.base_height_mm if base else 0.0,
    )
