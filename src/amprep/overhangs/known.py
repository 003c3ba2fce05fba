"""Find the overhangs of a part once for all of its positions with the same rotation and height."""

from collections.abc import Sequence

import numpy as np

from amprep.arrays import Floats
from amprep.model.build import PlacedPart
from amprep.model.control import Stop
from amprep.model.mesh import Mesh
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.of_part import PartOverhangs, overhangs_of
from amprep.workers import share_out


class KnownOverhangs:
    """Overhangs of placed parts under the same rules, which copies in the same orientation share.

    Parameters
    ----------
    rules
        Overhang angle and limits.
    """

    def __init__(self, rules: SupportRules) -> None:
        self._rules = rules
        self._known: dict[tuple[object, ...], tuple[PlacedPart, PartOverhangs]] = {}

    def of(self, placed: PlacedPart) -> PartOverhangs:
        """Return the overhangs of a placed part, moved from another position of it where one is known."""
        key = _key(placed)
        if key not in self._known:
            self._known[key] = placed, overhangs_of(placed, self._rules)
        first, found = self._known[key]
        shift = np.array([*(placed.matrix - first.matrix)[:2, 3], 0.0])
        return moved_in_plan(found, shift) if shift.any() else found

    def find(self, parts: Sequence[PlacedPart], stop: Stop) -> None:
        """Find the overhangs of parts in several processes, for `of`; where it ends early, `of` finds the others."""
        new = list({key: each for each in reversed(parts) if (key := _key(each)) not in self._known}.values())
        work = [float(len(each.part.mesh.triangles)) for each in new]
        found = share_out(lambda number: overhangs_of(new[number], self._rules), work, is_cancelled=stop)
        self._known |= {
            _key(placed): (placed, overhangs) for placed, overhangs in zip(new, found, strict=False)
        }


def _key(placed: PlacedPart) -> tuple[object, ...]:
    """Return what the overhangs of a part depend on, apart from its position in plan."""
    part, matrix = placed.part, placed.matrix
    own = part.overrides.overhang_angle_deg, part.overrides.supports
    return id(part.mesh), id(part.regions), own, matrix[:3, :3].tobytes(), float(matrix[2, 3])


def moved_in_plan(found: PartOverhangs, shift: Floats) -> PartOverhangs:
    """Return the overhangs of a part after a translation ``(3,)`` mm, which is parallel to the plate."""
    regions = tuple(each._replace(centre=each.centre + shift) for each in found.overhangs.regions)
    mesh = Mesh(found.mesh.vertices + shift, found.mesh.triangles)
    return PartOverhangs(mesh, found.overhangs._replace(regions=regions))
