"""Judge whether loose powder can leave supports."""

from amprep.checks.violation import Violation, place_words
from amprep.geometry.powder.pockets import find_pockets
from amprep.model.build import Build
from amprep.model.control import Stop
from amprep.model.counting import counted

PROMISE = "powder can leave"
"""Name of the promise."""

HOLE = 0.2
"""Diameter (mm) of a ball that must be able to leave."""


def check_powder(build: Build, stop: Stop) -> list[Violation]:
    """Return the supports in which a ball of `HOLE` fits that cannot leave; walls without thickness are not judged.

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
    return found
