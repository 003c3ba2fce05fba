"""Advice on the supports of a build: what to try where something stays unsupported."""

from collections import Counter
from collections.abc import Iterator

from amprep.job import Job
from amprep.model import Build
from amprep.model.supports import CAPACITY, CONNECTOR_BLOCKED, ENCLOSED, NO_FREE_VOXEL_BELOW, OUT_OF_TIME
from amprep.supports.grid.sizing import estimated_megabytes, usual_pitch


def advice_for(job: Job, build: Build, pitch: float) -> Iterator[str]:
    """Say where another grid, other rules or more time would serve the build better; minor regions do not count."""
    usual, wishes = usual_pitch(build.parts), job.supports
    if wishes.pitch_mm is None and pitch > usual:
        yield (
            f"the support grid was coarsened from {usual:g} to {pitch:g} mm to keep to supports.memory_mb = "
            f"{wishes.memory_mb}"
        )
    counts = Counter(each.reason for each in build.unsupported if not each.minor)
    narrow = counts[NO_FREE_VOXEL_BELOW] + counts[CONNECTOR_BLOCKED]
    if narrow:
        yield (
            f"{_regions(narrow)} unsupported for want of room below in a grid of {pitch:g} mm; a finer one may reach "
            f"what is not inside the part: {_finer(job, build, pitch)}"
        )
    if counts[ENCLOSED] and wishes.grounding == "plate-only":
        yield (
            f"{_regions(counts[ENCLOSED])} without a way to the plate; columns may stand on the part itself below: "
            "--set supports.grounding=anywhere"
        )
    if counts[CAPACITY]:
        yield f"{_regions(counts[CAPACITY])} left out by capacities; let them grow: --set supports.escalation=cut"
    if counts[OUT_OF_TIME]:
        yield f"{_regions(counts[OUT_OF_TIME])} left out for want of time: allow a longer time limit"


def _regions(count: int) -> str:
    return "1 region is" if count == 1 else f"{count} regions are"


def _finer(job: Job, build: Build, pitch: float) -> str:
    """Return the settings of a grid half as wide, with the memory that it takes."""
    finer = round(pitch / 2, 1) if pitch >= 0.4 else pitch / 2
    words = f"--set supports.pitch_mm={finer:g}"
    takes = estimated_megabytes(build.parts, job.printer.space, finer, job.supports.strut_angle_deg)
    return words if takes <= job.supports.memory_mb else f"{words} --set supports.memory_mb={int(takes) + 1}"
