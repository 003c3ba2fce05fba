"""Judge whether loose powder can leave supports."""

from collections.abc import Sequence

from amprep.checks.violation import Violation, place_words
from amprep.geometry.powder.cavities import find_cavities
from amprep.geometry.powder.pockets import Pocket, find_pockets
from amprep.model.build import Build, SupportBody
from amprep.model.control import Stop
from amprep.model.counting import counted

PROMISE = "powder can leave"
"""Name of the promise."""

HOLE = 0.2
"""Diameter (mm) of a ball that must be able to leave."""


def check_powder(build: Build, stop: Stop) -> list[Violation]:
    """Return the supports with powder that cannot leave; walls without thickness are not judged.

    It is in pockets in which a ball of `HOLE` fits that cannot leave, or in closed cavities, however narrow.

    The flood fill is that which measures trapped powder for reports, and which looks for places of drain holes. It
    knows nothing of cells.
    """
    found = []
    for body in build.supports:
        if stop():
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
    """Name closed cavities that no pocket is in: they are too narrow for a ball."""
    cavities = find_cavities(body.mesh.arrays, pockets)
    if not cavities:
        return []
    count = counted(len(cavities), "closed cavity", "closed cavities")
    message = (
        f"{sum(each.volume for each in cavities):.3g} mm3 of powder in {count} too narrow for a ball of {HOLE:g} mm, "
        f"the largest at {place_words(cavities[0].point)} mm"
    )
    return [Violation(PROMISE, body.name, message)]
