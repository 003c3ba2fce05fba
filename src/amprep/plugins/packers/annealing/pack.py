"""The packer `annealing`: bodies of any shape move without ever intersecting (thesis 2.6)."""

import numpy as np

from amprep.model.bounding_volume import Boxes
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem, Placement, Unplaced, require_values
from amprep.plugins.packers.annealing.course import Annealing, Builds
from amprep.plugins.packers.annealing.params import AnnealingParams
from amprep.plugins.packers.annealing.scene import fits_by_size, prepare_volumes
from amprep.plugins.packers.annealing.start import start_layout


def pack_annealing(
    problem: PackingProblem,
    *,
    params: AnnealingParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Pack by simulated annealing on the bounding volumes themselves (thesis 2.6).

    The packing is never worse than the first layout, which another packer makes. From there all motions are continuous
    or begin outside, so no parts interlock unless they interlock at first; parts with one box each never do.

    Raises
    ------
    AmprepError
        If a value is out of range, or the collision engine cannot handle the volumes.
    """
    require_values(problem)
    start = start_layout(problem, params.start, rng, stop)
    prepared = prepare_volumes(problem, params.collision)
    annealing = Annealing(prepared, start, params, rng)
    too_large = {entry.item for entry in start.unplaced if _is_too_large(annealing, entry)}
    builds, reason = annealing.pack(too_large, stop, progress)
    return _finish(annealing, builds, too_large, reason)


def _is_too_large(annealing: Annealing, entry: Unplaced) -> bool:
    """Return whether an item that the first layout lacks certainly fits no build."""
    item = annealing.problem.items[entry.item]
    if isinstance(item.volume, Boxes) and item.orientations.freedom == "list" and entry.reason == "too large":
        return True
    return not fits_by_size(annealing.prepared, entry.item)


def _finish(annealing: Annealing, builds: Builds, too_large: set[int], reason: str) -> Packing:
    """Return the builds as a packing, with the bound and a reason for every unplaced item."""
    problem = annealing.problem
    placed = {item for build in builds for item in build}
    left = "out of time" if reason in {"time limit", "interrupted"} else "no room left"
    out = [item for item in range(len(problem.items)) if item not in placed]
    reached, bound = annealing.reached(builds), annealing.bound(too_large)
    sign = -1.0 if problem.objective == "fill" else 1.0
    incomplete = problem.objective != "fill" and bool(out)
    if not incomplete and sign * (reached - bound) <= 1e-6 * max(1.0, abs(reached)):
        bound, status = reached, "optimal"
    else:
        status = "infeasible" if incomplete and too_large else "feasible"
    return Packing(
        builds=tuple(_ordered(problem, build, number) for number, build in enumerate(builds)),
        unplaced=tuple(Unplaced(item, "too large" if item in too_large else left) for item in out),
        bound=bound,
        status=status,  # type: ignore[arg-type]
        stop_reason=reason or "finished",
        bound_for=problem.bound_for,
    )


def _ordered(problem: PackingProblem, build: dict[int, Placement], number: int) -> tuple[Placement, ...]:
    """Return the placements of a build: the fixed ones first, then by item."""
    fixed = problem.fixed if number == 0 else ()
    still = {placement.item for placement in fixed}
    return (*fixed, *(build[item] for item in sorted(build) if item not in still))
