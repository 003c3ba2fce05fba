"""The packer `block-building`: fills one build with blocks of boxes, by beam searches side by side."""

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from amprep.kernels.blocks import beam_search as kernel
from amprep.model.control import Progress, Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.plugins.packers.block_building.beam_search import Filling, Manner, Worker
from amprep.plugins.packers.block_building.integer_instance import Whole, whole_scene
from amprep.plugins.packers.instance.orders import Pass
from amprep.plugins.packers.instance.prepare import Scene, prepare
from amprep.plugins.packers.instance.solution import Solution, as_packing, value_of
from amprep.plugins.packers.params import BlockBuildingParams

MANNERS = (Manner(), Manner(fill=1.0, power=3, margin=0.0, density=1.0))
"""How the workers differ: blocks that waste little, and such that waste nothing."""

PAUSE = 0.01
"""Seconds between two looks at `stop`."""


def pack_block_building(
    problem: PackingProblem,
    *,
    params: BlockBuildingParams,
    rng: np.random.Generator,
    stop: Stop,
    progress: Progress,
) -> Packing:
    """Fill one build with blocks of boxes (Araya and Riff 2014, doi:10.1016/j.cor.2013.09.003).

    Boxes are joined to blocks that leave little unused inside. A state is a partly filled build with its
    maximal empty spaces; the space nearest to a corner of the build takes one of the best blocks at that
    corner; a state is worth what a greedy completion makes of it; and a beam search keeps the best states,
    with a wider beam each time. Two searches with different blocks run side by side, and the better answer
    counts. In the end all boxes are pushed down and to the corner, and what then finds room is added.
    """
    del rng
    scene = prepare(problem)
    found, reason = fill_by_blocks(scene, params, stop, progress)
    return as_packing(scene, found, reason)


def fill_by_blocks(
    scene: Scene, params: BlockBuildingParams, stop: Stop, progress: Progress
) -> tuple[Solution, str]:
    """Return the best filling found and why the search ended.

    Each worker's course depends on its own work alone. Of equal answers that found with less work counts,
    then the first worker's, so that time changes nothing as long as it does not end the search.
    """
    whole = whole_scene(scene)
    workers = [
        Worker(whole, manner, blocks=params.blocks, work=params.work / len(MANNERS), flat=scene.space.flat)
        for manner in MANNERS
    ]
    if len(whole.singles):
        _run(workers, stop, progress)
    best = min(workers, key=lambda worker: (-worker.filling.value, worker.met))
    filling = best.settled() if len(whole.singles) else best.filling
    return as_solution(scene, whole, filling), _reason(workers, best, stop)


def _run(workers: Sequence[Worker], stop: Stop, progress: Progress) -> None:
    """Run the workers, each in a thread of its own; the kernels leave the interpreter free."""
    begun = time.monotonic()
    whole = begun + stop.remaining()
    with ThreadPoolExecutor(len(workers)) as pool:
        running = [pool.submit(worker.run) for worker in workers]
        while not all(future.done() for future in running):
            time.sleep(PAUSE)
            if stop():
                for worker in workers:
                    worker.control[kernel.STOP] = 1
            for worker in workers:
                if worker.reached:
                    _limit(workers, worker.met)
            progress(_share(workers, begun, whole), "building blocks")
        for future in running:
            future.result()


def _limit(workers: Sequence[Worker], work: int) -> None:
    """Let no worker go on beyond `work`: later answers would not count."""
    for worker in workers:
        worker.control[kernel.LIMIT] = min(int(worker.control[kernel.LIMIT]), work)


def _share(workers: Sequence[Worker], begun: float, end: float) -> float:
    """Return how much of the time or the work is used up."""
    worked = max(worker.control[kernel.WORK] / max(worker.control[kernel.LIMIT], 1) for worker in workers)
    return float(min(max(worked, (time.monotonic() - begun) / max(end - begun, 1e-9)), 1.0))


def _reason(workers: Sequence[Worker], best: Worker, stop: Stop) -> str:
    if best.reached:
        return "bound met"
    if stop():
        return stop.reason
    return "no better one found" if all(worker.finished for worker in workers) else "work used up"


def as_solution(scene: Scene, whole: Whole, filling: Filling) -> Solution:
    """Return the filling with an item for each box, in the form of the other packers."""
    n = len(scene.kind)
    build, variant, place = np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros((n, 3))
    left = [list(items) for items in whole.items]
    for single, box in zip(filling.single.tolist(), filling.boxes, strict=True):
        item = left[whole.kind[single]].pop(0)
        build[item], variant[item] = 0, whole.variant[single]
        place[item] = scene.space.lo + box[:3] * whole.unit
    order = Pass(np.flatnonzero(build >= 0), np.zeros(6))
    return Solution(order, (-value_of(scene, build),), True, build, variant, place)
