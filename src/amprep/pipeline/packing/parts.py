"""The bound for the parts themselves, where the packer got other volumes or fewer orientations."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from amprep.measures.objective import objective_reached
from amprep.measures.parts_bound import parts_bound
from amprep.measures.too_large import proved_too_large
from amprep.model import Packing, PackingProblem, Part, Solid

SLACK = 1e-6
"""Fraction by which a packing may be better than a bound for rounding."""


def bound_for_parts(parts: Sequence[Part], problem: PackingProblem, packing: Packing) -> float | None:
    """Return a bound on the objective for any packing of the parts; None if it is not known.

    It is that of the packer if that is one for the parts. Surfaces have no volume: with them no bound is known.
    """
    if packing.bound_for == "shapes" or not problem.items:
        return packing.bound
    if problem.objective == "builds" and len(packing.builds) == 1:
        return 1.0
    if not all(part.is_solid for part in parts):
        return None
    solids = [Solid(part.mesh) for part in parts]
    items = tuple(
        replace(item, volume=solids[item.part], orientations=parts[item.part].orientations, turn=np.eye(3))
        for item in problem.items
    )
    fixed = tuple(
        replace(each, rotation=each.rotation @ problem.items[each.item].turn) for each in problem.fixed
    )
    own = replace(problem, items=items, fixed=fixed)
    too_large = proved_too_large(own, [each.item for each in packing.unplaced if each.reason == "too large"])
    bound, reached = parts_bound(own, too_large), objective_reached(problem, packing)
    if packing.unplaced and problem.objective != "fill":
        return bound
    # a packer of other volumes may not keep all of the rules that the bound relies on
    better = reached - bound if problem.objective == "fill" else bound - reached
    return bound if better <= SLACK * max(1.0, abs(bound)) else None
