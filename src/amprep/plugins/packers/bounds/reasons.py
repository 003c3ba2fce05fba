"""Claim only what is proved of items that are left out: too large, and infeasible."""

from dataclasses import replace

from amprep.measures.too_large import proved_too_large
from amprep.model.packing import Packing, PackingProblem

TOO_LARGE, NO_ROOM = "too large", "no room left"


def with_proved_reasons(problem: PackingProblem, packing: Packing) -> Packing:
    """Return a packing whose items are reported as too large only where that is proved.

    A packer of curved parts may know no position for an item, because it packs volumes around the part or tries some
    angles only. Without a proof the packing is not infeasible, and such items count in a bound on the value.
    """
    claimed = {each.item for each in packing.unplaced if each.reason == TOO_LARGE}
    doubtful = claimed - proved_too_large(problem, claimed)
    if not doubtful:
        return packing
    unplaced = tuple(
        replace(each, reason=NO_ROOM) if each.item in doubtful else each for each in packing.unplaced
    )
    status, bound = packing.status, packing.bound
    if status == "infeasible" and doubtful == claimed:
        status = "feasible"
    if problem.objective == "fill" and bound is not None:
        value = sum(problem.items[item].value for item in doubtful)
        status = "feasible" if value > 0.0 else status
        bound += value
    return replace(packing, unplaced=unplaced, status=status, bound=bound)
