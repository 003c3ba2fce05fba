"""Adjust a packing after the packer: no locked parts, and more equal layers, where the job asks for it."""

from collections.abc import Sequence

from amprep.job import PackingSettings
from amprep.model import Packing, PackingProblem, Part, Stop
from amprep.model.counting import counted
from amprep.repacking.even_layers import Evened, even_layers
from amprep.repacking.interlocking import FreedPacking, free_locked_items


def adjusted(
    problem: PackingProblem, packing: Packing, parts: Sequence[Part], settings: PackingSettings, stop: Stop
) -> tuple[Packing, tuple[str, ...]]:
    """Return the packing that the job asks for, and one note on each change.

    Parameters
    ----------
    problem, packing
        The problem, and the packer's answer.
    parts
        The parts of the job.
    settings
        Whether interlocking is forbidden, and layers are to be more equal.
    stop
        Ends both adjustments early.
    """
    notes: list[str] = []
    if settings.interlocking == "forbid":
        freed = free_locked_items(problem, packing, stop)
        packing = freed.packing
        notes += _moved(problem, freed, parts)
    if settings.even_layers and packing.builds:
        evened, gains = even_layers(problem, packing, parts, stop)
        locks = settings.interlocking == "forbid" and bool(free_locked_items(problem, evened, stop).moved)
        packing = packing if locks else evened
        notes += [] if locks else map(_gain, gains)
    return packing, tuple(notes)


def _moved(problem: PackingProblem, freed: FreedPacking, parts: Sequence[Part]) -> list[str]:
    if not freed.moved:
        return []
    names = sorted({parts[problem.items[item].part].name for item in freed.moved})
    count = counted(len(freed.moved), "locked part")
    return [f"{count} placed elsewhere or unplaced, because interlocking is forbidden: {', '.join(names)}"]


def _gain(evened: Evened) -> str:
    change = f"from {100 * evened.before:.0f} to {100 * evened.after:.0f} %"
    moved = counted(evened.moved, "part")
    return f"build {evened.build}: {moved} moved vertically; variation of the cross-sections {change}"
