"""The packer `block-building`: fill one build with blocks of boxes, by two beam searches in parallel."""

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from amprep.kernels.blocks import records
from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.block_building.beam_search import PackedBoxes, SearchSettings, Worker
from amprep.plugins.packers.block_building.integer_instance import IntegerInstance, integer_instance
from amprep.plugins.packers.bounds.combinatorial import fill_bound
from amprep.plugins.packers.instance.arrangement import PackerResult, as_packing
from amprep.plugins.packers.instance.prepare import PreparedInstance, prepare
from amprep.plugins.packers.params import BlockBuildingParams, ExtremePointsParams

WORKERS = (SearchSettings(), SearchSettings(min_fill=1.0, power=3, margin=0.0, density=1.0))
"""Settings of the two workers: blocks with little waste, and blocks with none."""

POLL_INTERVAL = 0.01
"""Seconds between two calls of `stop`."""


def pack_block_building(
    problem: PackingProblem,
    *,
    params: BlockBuildingParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Fill one build with blocks of boxes, or make one low (Araya and Riff 2014, doi:10.1016/j.cor.2013.09.003).

    Boxes are joined to blocks that leave little unused space inside. A state is a partly filled build with its
    maximal empty spaces. Each move places one of the best blocks in the space nearest to a corner of the
    build, at that corner. A state is valued by the packing that a greedy completion makes of it. A beam search
    keeps the best states and is repeated with a wider and wider beam. Two searches with different blocks run
    in parallel, and the better packing counts. At the end all boxes are pushed down and to the corner, and the
    space gained is filled.

    Parameters
    ----------
    problem
        Items of one box each, to fill one build that is a box.
    params
        Number of blocks and work limit.
    rng
        Not used: the search is deterministic.
    stop, progress
        Checked and called about a hundred times a second.
    """
    prepared = prepare(problem)
    if problem.objective == "height":
        return as_packing(prepared, _lowest(prepared, params, rng, stop, progress))
    return as_packing(prepared, fill_by_blocks(prepared, params, stop, progress))


def _lowest(
    prepared: PreparedInstance,
    params: BlockBuildingParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> PackerResult:
    """Return the lowest packing in one build; the start is that of `extreme-points`."""
    from amprep.plugins.packers.block_building.lowest import lowest_by_blocks
    from amprep.plugins.packers.lowest_build import lowest_by_orderings

    start = lowest_by_orderings(prepared, params=ExtremePointsParams(), rng=rng, stop=stop, progress=progress)
    return lowest_by_blocks(prepared, start, params, stop, progress)


def fill_by_blocks(
    prepared: PreparedInstance, params: BlockBuildingParams, stop: Stop, progress: Progress
) -> PackerResult:
    """Return the best packing found, its bound and the reason why the search ended.

    The course of each worker depends on its own work alone. Among packings of equal value, the one found with
    less work counts, then that of the first worker. So the answer does not depend on time unless time ends the
    search.

    Parameters
    ----------
    prepared
        The prepared problem.
    params
        Number of blocks and work limit; each worker gets an equal part of the work.
    stop, progress
        As in `pack_block_building`.
    """
    instance = integer_instance(prepared)
    work, flat = params.work / len(WORKERS), prepared.space.flat
    workers = [Worker(instance, each, blocks=params.blocks, work=work, flat=flat) for each in WORKERS]
    if len(instance.boxes.size):
        _run(workers, stop, progress)
    best = min(workers, key=lambda worker: (-worker.packed.value, worker.found_at))
    packed = best.compacted() if len(instance.boxes.size) else best.packed
    found = _arrangement(prepared, instance, packed)
    return PackerResult(found, fill_bound(prepared), _reason(workers, best, stop))


def _run(workers: Sequence[Worker], stop: Stop, progress: Progress) -> None:
    """Run each worker in its own thread; the kernels release the interpreter lock."""
    begun = time.monotonic()
    end = begun + stop.remaining()
    with ThreadPoolExecutor(len(workers)) as pool:
        running = [pool.submit(worker.run) for worker in workers]
        while not all(future.done() for future in running):
            time.sleep(POLL_INTERVAL)
            if stop():
                for worker in workers:
                    worker.control[records.STOP] = 1
            for worker in workers:
                if worker.reached_goal:
                    _limit(workers, worker.found_at)
            progress(_fraction(workers, begun, end), "building blocks")
        for future in running:
            future.result()


def _limit(workers: Sequence[Worker], work: int) -> None:
    """Stop each worker at `work`: packings found later would not count."""
    for worker in workers:
        worker.control[records.LIMIT] = min(int(worker.control[records.LIMIT]), work)


def _fraction(workers: Sequence[Worker], begun: float, end: float) -> float:
    """Return the fraction of the time or of the work that is used up."""
    worked = max(worker.control[records.WORK] / max(worker.control[records.LIMIT], 1) for worker in workers)
    return float(min(max(worked, (time.monotonic() - begun) / max(end - begun, 1e-9)), 1.0))


def _reason(workers: Sequence[Worker], best: Worker, stop: Stop) -> str:
    if best.reached_goal:
        return "bound met"
    if stop():
        return stop.reason
    return "no better one found" if all(worker.finished for worker in workers) else "work used up"


def _arrangement(prepared: PreparedInstance, instance: IntegerInstance, packed: PackedBoxes) -> Arrangement:
    """Return the packed boxes with an item assigned to each."""
    found = Arrangement.unassigned(len(prepared.type_of))
    left = [list(items) for items in instance.items]
    for box, corners in zip(packed.box.tolist(), packed.corners, strict=True):
        item = left[instance.boxes.item_type[box]].pop(0)
        found.build[item], found.orientation[item] = 0, instance.orientation[box]
        found.position[item] = prepared.space.lo + corners[:3] * instance.unit
    return found
