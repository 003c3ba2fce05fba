"""Estimate what making supports solid takes; leave out what does not end in time, refuse what memory cannot hold."""

import os
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools
from amprep.cells.answers import Emit
from amprep.cells.samples import column_for
from amprep.errors import JobError
from amprep.model.control import Stop
from amprep.model.supports import OUT_OF_TIME
from amprep.model.supports.edges import square_keys
from amprep.model.supports.rules import SectionRules, SupportRules
from amprep.supports.layout import SupportLayout

SECONDS, MEGABYTES = 1e-4, 3.5e-3
"""Processor time and memory that each triangle of a cell takes, measured with 4,000 to 16,000 edges of `x-wall`."""

_CUBE = 10
"""Number of triangles by which a cell is cheaper: the faces of neighbours cancel, and whole prisms are quick."""


class Effort(NamedTuple):
    """What one edge of supports takes: processor time in seconds, and memory in MB."""

    seconds: float
    megabytes: float


def within_means(layout: SupportLayout, emit: Emit, rules: SupportRules, stop: Stop) -> SupportLayout:
    """Return a layout without the supports that cannot be finished in time.

    Parameters
    ----------
    layout
        Routed supports of the build.
    emit
        Calls the cell.
    rules
        The least wall, and the leg ratio, by which cells choose default sizes.
    stop
        Has the deadline.

    Raises
    ------
    JobError
        If the supports need more memory than this machine has.
    """
    if not len(layout.edges):
        return layout
    effort = effort_of(emit, layout.grid.pitch, layout.grid.step, rules)
    layout = leave_out_late(layout, effort, stop)
    require_memory(layout, effort)
    return layout


def effort_of(emit: Emit, pitch: float, step: float, rules: SectionRules) -> Effort:
    """Return what one edge takes, by the triangles of a cell in the middle of a column.

    Parameters
    ----------
    emit
        Calls the cell.
    pitch, step
        Width and height (mm) of a voxel.
    rules
        The least wall, and the leg ratio, by which cells choose default sizes.
    """
    request = column_for(pitch, step, rules)
    cells = emit(request)
    count = sum(len(cells.templates[each].mesh.triangles) for each in cells.template.tolist())
    triangles = max(count / len(request.edges) - _CUBE, 1.0)
    return Effort(SECONDS * triangles, MEGABYTES * triangles)


def require_memory(layout: SupportLayout, effort: Effort) -> None:
    """Refuse supports that take more memory than this machine has.

    Raises
    ------
    JobError
        With a pitch at which their number fits.
    """
    needed, available = effort.megabytes * len(layout.edges), machine_megabytes()
    if needed <= available:
        return
    pitch = layout.grid.pitch
    fitting = round(pitch * (needed / available) ** (1 / 3) + 0.05, 1)
    raise JobError(
        f"supports of {len(layout.edges)} cells at a pitch of {pitch:g} mm take about {needed / 1000:.3g} GB of "
        f"memory, and this machine has {available / 1000:.3g}: choose a larger pitch (--set supports.pitch_mm="
        f"{fitting:g}) or a simpler cell (--cell prism)"
    )


def machine_megabytes() -> float:
    """Return the memory of this machine in MB; infinity where the system does not tell."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 1e6
    except (AttributeError, ValueError, OSError):
        return float("inf")


def leave_out_late(layout: SupportLayout, effort: Effort, stop: Stop) -> SupportLayout:
    """Return a layout without the groups that cannot be made solid before a deadline; the smallest come first."""
    seconds = effort.seconds * np.bincount(layout.edges.group, minlength=len(layout.group_parts))
    order = np.argsort(seconds, kind="stable")
    late = np.zeros(len(seconds), np.bool_)
    late[order] = np.cumsum(seconds[order]) > max(stop.remaining(), 0.0)
    return _without(layout, late) if late.any() else layout


def _without(layout: SupportLayout, late: Bools) -> SupportLayout:
    """Return a layout without groups ``(g,)``; their red squares are out of time."""
    lost = layout.connected & late[layout.red_group]
    edges, feet = layout.edges[~late[layout.edges.group]], layout.feet
    connected = layout.connected & ~lost
    stood_on = square_keys(np.concatenate([edges.lower, layout.red.square[connected]]))
    return replace(
        layout,
        connected=connected,
        reasons=tuple(OUT_OF_TIME if gone else why for gone, why in zip(lost, layout.reasons, strict=True)),
        edges=edges,
        red_group=np.where(connected, layout.red_group, -1),
        feet=feet[np.isin(square_keys(feet[:, :3]), stood_on)],
    )
