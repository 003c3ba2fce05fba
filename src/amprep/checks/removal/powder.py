"""Judge whether loose powder can leave supports."""

from collections.abc import Sequence

import numpy as np

from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.shells import measure_shells
from amprep.geometry.powder.pockets import Pocket, find_pockets
from amprep.model.build import Build, SupportBody
from amprep.model.control import Stop
from amprep.model.counting import counted

PROMISE = "powder can leave"
"""Name of the promise."""

HOLE = 0.2
"""Diameter (mm) of a ball that must be able to leave."""


_GRAIN = 1e-4
"""Volume (mm3) below which a closed cavity holds hardly a grain of powder: a ball of 0.06 mm in diameter."""


def check_powder(build: Build, stop: Stop) -> list[Violation]:
    """Return the supports with powder that cannot leave; walls without thickness are not judged.

    It is in pockets in which a ball of `HOLE` fits that cannot leave, or in closed cavities, however narrow.

    The flood fill is that which measures trapped powder for reports, and which looks for places of drain holes. It
    knows nothing of cells.
    """
    found = []
    for body in build.supports:
        if stop.cancelled.is_set():
            break
        if body.surface or not len(body.mesh.triangles):
            continue
        held = [build.parts[index].mesh.arrays for index in body.parts]
        pockets = find_pockets([body.mesh.arrays], held, HOLE)
        if pockets:
            volume, place = sum(each.volume for each in pockets), place_words(pockets[0].point)
            message = (
                f"{volume:.3g} mm3 of powder in {counted(len(pockets), 'pocket')}, the largest at {place} mm"
            )
            found.append(Violation(PROMISE, body.name, message))
        found += _narrow_cavities(body, pockets)
    return found


def _narrow_cavities(body: SupportBody, pockets: Sequence[Pocket]) -> list[Violation]:
    """Name closed cavities that no pocket is in: shells of negative volume, which are too narrow for a ball."""
    shells = measure_shells(*body.mesh.arrays)
    points = np.array([each.point for each in pockets]).reshape(-1, 3)
    inside = (points >= shells.lo[:, None]) & (points <= shells.hi[:, None])
    cavity = np.flatnonzero((shells.volume < -_GRAIN) & ~np.any(np.all(inside, axis=2), axis=1))
    if not len(cavity):
        return []
    largest = cavity[shells.volume[cavity].argmin()]
    place = place_words((shells.lo[largest] + shells.hi[largest]) / 2.0)
    count = counted(len(cavity), "closed cavity", "closed cavities")
    message = (
        f"{-shells.volume[cavity].sum():.3g} mm3 of powder in {count} too narrow for a ball of {HOLE:g} mm, "
        f"the largest at {place} mm"
    )
    return [Violation(PROMISE, body.name, message)]
