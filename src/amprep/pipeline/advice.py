"""Advise on settings that would support more of a build."""

from collections import Counter
from collections.abc import Iterator

from amprep.job import Job
from amprep.model import Build
from amprep.model.supports import (
    CAPACITY,
    CONNECTOR_BLOCKED,
    ENCLOSED,
    NO_FREE_VOXEL_BELOW,
    OUT_OF_TIME,
    SLENDER,
    TERRITORY,
    Grounding,
)
from amprep.supports.grid.sizing import choose_pitch, estimated_megabytes, least_pitch, usual_pitch


def advice_for(job: Job, build: Build, pitch: float) -> Iterator[str]:
    """Yield sentences that name the settings to change for regions that are unsupported; minor regions do not count.

    Parameters
    ----------
    job
        The job of the build.
    build
        The finished build, with its unsupported regions.
    pitch
        Horizontal voxel size of the support grid, mm.
    """
    rules = job.supports
    usual = usual_pitch(build.parts, rules.least_wall_mm)
    if rules.pitch_mm is None and choose_pitch(build.parts, job.printer.space, rules) > usual:
        yield (
            f"the pitch of the support grid was raised from {usual:g} to {pitch:g} mm, so that the grid fits into "
            f"{rules.memory_mb} MB (supports.memory_mb)"
        )
    counts = Counter(each.reason for each in build.unsupported if not each.minor)
    narrow = counts[NO_FREE_VOXEL_BELOW] + counts[CONNECTOR_BLOCKED]
    if narrow:
        yield (
            f"{_have(narrow)} no free voxel below {'it' if narrow == 1 else 'them'} at a pitch of {pitch:g} mm; "
            f"{_finer(job, build, pitch)}"
        )
    if counts[ENCLOSED] and rules.grounding == "plate-only":
        yield (
            f"{_have(counts[ENCLOSED])} no path to the build plate; let supports stand on their own part: "
            "--set supports.grounding=anywhere"
        )
    if counts[TERRITORY]:
        yield (
            f"{_have(counts[TERRITORY])} a path only outside the territory of the part or with more drift than allowed"
            f"{_stand_on_part(rules.grounding)}; allow such paths: --set supports.territory=shared, or a larger "
            "supports.territory_margin_mm or supports.drift_ratio"
        )
    if counts[SLENDER]:
        yield (
            f"{_have(counts[SLENDER])} no support, because it would be a leg of more than {rules.leg_ratio:g} to 1 "
            "without room for a strut; choose a wider cell or a larger pitch, or allow them: --set supports.leg_ratio=0"
        )
    if counts[CAPACITY]:
        yield (
            f"{_have(counts[CAPACITY])} a path that other supports use up already; allow more supports to share it: "
            "--set supports.escalation=cut"
        )
    if counts[OUT_OF_TIME]:
        yield f"{_have(counts[OUT_OF_TIME])} no support yet, because the time ended; allow a longer time limit"


def _stand_on_part(grounding: Grounding) -> str:
    """Return the advice to let supports stand on parts, empty where they may already."""
    if grounding == "anywhere":
        return ""
    return "; let supports stand on their own part: --set supports.grounding=anywhere"


def _have(count: int) -> str:
    return "1 region has" if count == 1 else f"{count} regions have"


def _finer(job: Job, build: Build, pitch: float) -> str:
    """Return the options for half the pitch and the memory that it takes, or that no finer pitch suits the walls."""
    least = least_pitch(job.supports.least_wall_mm)
    finer = max(round(pitch / 2, 1) if pitch >= 0.4 else pitch / 2, least)
    if finer >= pitch:
        return f"a finer one is no remedy, because walls of {job.supports.least_wall_mm:g} mm would close its cells"
    options = f"--set supports.pitch_mm={finer:g}"
    needed = estimated_megabytes(build.parts, job.printer.space, finer, job.supports.strut_angle_deg)
    if needed > job.supports.memory_mb:
        options += f" --set supports.memory_mb={int(needed) + 1}"
    return f"a finer pitch may reach those outside the part: {options}"
