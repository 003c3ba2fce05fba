"""Describe a part: contents, problems, overhangs, and the printers that it fits."""

from collections.abc import Iterator, Sequence

import numpy as np

from amprep.job import Job, Printer, list_printers
from amprep.measures.contents import MeshContents, measure_contents
from amprep.measures.overhangs import measure_overhangs
from amprep.measures.printer_fit import PartPoses, poses_of
from amprep.measures.thin_walls import ThinWall, measure_thin_walls
from amprep.model import Part, PlacedPart
from amprep.model.counting import counted
from amprep.report.inspection.record import InspectedPart, PrinterFit, fit_words

SMALL_MM, LARGE_MM = 1.0, 2000.0
"""Longest sides below and above which the unit of a file is doubtful."""

_NOTICED = 0.01
"""Fraction of the surface from which thin walls are a finding."""


def describe_part(part: Part, problem: str, job: Job) -> InspectedPart:
    """Return everything that is found about a part but its bounding volumes.

    Parameters
    ----------
    part
        The part after repair, or as it was read if its mesh cannot be used.
    problem
        Why its mesh cannot be used; empty if it can.
    job
        Printer, clearance, lift and rules for overhangs.
    """
    if problem:
        return InspectedPart(part, problems=(problem,), findings=part.notes)
    contents, fits = measure_contents(part), _fits(part, job)
    walls = measure_thin_walls(part.mesh) if part.is_solid else ()
    problems = (*_problems(part), *_misfits(fits, job))
    notes = (note for note in part.notes if not note.startswith("not a solid: "))
    return InspectedPart(
        part,
        contents,
        problems,
        (*notes, *_findings(contents), *_thin(walls, contents)),
        measure_overhangs(_on_plate(part, job.packing.lift_mm), job.supports),
        walls,
        fits,
    )


def _on_plate(part: Part, lift: float) -> PlacedPart:
    """Return the part as it lies, `lift` mm above the plate."""
    matrix = np.eye(4)
    matrix[2, 3] = lift - float(part.mesh.bounds[0][2])
    return PlacedPart(part.name, part, matrix, part.orientations)


def _problems(part: Part) -> Iterator[str]:
    for note in part.notes:
        if note.startswith("not a solid: "):
            yield note.removesuffix("; taken as a surface")


def _misfits(fits: tuple[PrinterFit, ...], job: Job) -> Iterator[str]:
    able = [each for each in fits if each.fit in ("as it lies", "in an allowed orientation")]
    if able:
        return
    turned = [each.printer for each in fits if each.fit == "in another orientation"]
    which = f"{job.printer.name}" if len(fits) == 1 else "no known printer"
    words = f"it does not fit {which}" if len(fits) == 1 else f"it fits {which}"
    advice = f"; it would fit {turned[0]} if it may be turned" if turned else ""
    yield f"{words} with {fit_words(fits)}{advice}"


def _findings(contents: MeshContents) -> Iterator[str]:
    if contents.nonmanifold_edges:
        edges = counted(contents.nonmanifold_edges, "edge")
        yield f"the surface touches itself: more than two triangles meet at {edges}"
    if contents.overlap_mm3:
        yield f"shells overlap one another, by {contents.overlap_mm3:.6g} mm3; they count once"
    if contents.cavities:
        words = counted(contents.cavities, "closed cavity", "closed cavities")
        yield f"{words}, which powder cannot leave"
    if contents.bodies > 1:
        yield f"it consists of {contents.bodies} bodies"
    longest = max(contents.size_mm)
    if not SMALL_MM <= longest <= LARGE_MM:
        yield f"its longest side is {longest:.4g} mm; check the unit of the file"


def _thin(walls: Sequence[ThinWall], contents: MeshContents) -> Iterator[str]:
    """Yield a sentence if more than a little of the surface has a wall of the smallest thickness that is measured."""
    if walls and walls[0].area_mm2 > _NOTICED * contents.area_mm2:
        percent = 100 * walls[0].area_mm2 / contents.area_mm2
        yield f"walls are thinner than {walls[0].below_mm:g} mm below {percent:.0f} % of the surface"


def _fits(part: Part, job: Job) -> tuple[PrinterFit, ...]:
    """Return whether the part fits the printer that the job names, or else each known printer."""
    poses = poses_of(part.mesh.vertices, part.orientations)
    printers = list_printers(job.folder)[0] if job.printer_is_default else [job.printer]
    return tuple(_fit(poses, each, *job.distances_on(each)) for each in printers)


def _fit(poses: PartPoses, printer: Printer, clearance: float, lift: float) -> PrinterFit:
    return PrinterFit(printer.name, poses.fit(printer.space, clearance, lift), clearance, lift)
