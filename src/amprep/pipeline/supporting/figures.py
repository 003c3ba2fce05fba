"""Figures on the removal of supports, and the densities of parts."""

from amprep.job import Job
from amprep.materials.catalogue import densities_of
from amprep.measures.removability import Removal, RemovalRules, measure_removal
from amprep.model import (
    Build,
)


def removal_of(job: Job, build: Build) -> tuple[Removal, ...]:
    """Return the figures of each support body of `build`."""
    cells, density = job.cells, job.cells.density_g_cm3
    densities = part_densities(job, build) if density is None else (density,) * len(build.parts)
    rules = RemovalRules(job.supports.layer_mm, densities, cells.powder_hole_mm, cells.removability)
    return measure_removal(build, rules)


def part_densities(job: Job, build: Build) -> tuple[float | None, ...]:
    """Return the density (g/cm3) of each part: that of its own material, or else that of the job's."""
    return densities_of([placed.part.appearance.material for placed in build.parts], job.material, job.folder)
