"""Measures what the supports of a build cost and how they come off, as the job asks."""

from amprep.job import Job
from amprep.model import Build
from amprep.report.removability import Removal, RemovalRules, measure_removal


def removal_of(job: Job, build: Build) -> tuple[Removal, ...]:
    """Return the figures of each support body of `build`."""
    wishes = job.cells
    rules = RemovalRules(wishes.layer_mm, wishes.density_g_cm3, wishes.powder_hole_mm, wishes.removability)
    return measure_removal(build, rules)
