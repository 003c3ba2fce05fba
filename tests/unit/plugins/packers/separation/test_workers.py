"""Workers share layouts at fixed amounts of work, so that time does not change what they do."""

import time

import numpy as np
import pytest

from amprep.model import Stop
from amprep.plugins.packers.params import SeparationParams
from amprep.plugins.packers.separation.state import Scene, WorkBudget, nothing_placed
from amprep.plugins.packers.separation.workers import DELAY, Exchange, SharedLayout, run_workers


def scene_for(workers=2, work=20 * DELAY, seed=1, stop=None):
    params = SeparationParams(workers=workers, work=work / 1e6)
    return Scene(None, None, params, np.random.default_rng(seed), WorkBudget(stop or Stop(), work))


def placed(number):
    """A layout that only tells its number."""
    return nothing_placed()._replace(items=np.array([number]))


def test_a_layout_is_known_to_its_finder_at_once_and_to_others_after_the_delay():
    exchange = Exchange([0.0, 100.0], 10.0, -np.inf)
    exchange.publish(SharedLayout(3.0, 5.0, 1, placed(1)))
    own = exchange.best(1, 5.0)
    assert own is not None
    assert own.value == 3.0
    assert exchange.best(0, 14.9) is None
    assert exchange.best(0, 15.0) is own


def walk(worker, wait, trace):
    """A toy search: random values, which get better from the best one that is known."""
    value = 1000.0
    while not worker.over():
        worker.scene.budget.left -= DELAY * worker.scene.rng.uniform(0.05, 0.3)
        if wait.random() < 0.2:
            time.sleep(0.02 * wait.random())
        news = worker.better_than(value)
        value = value if news is None else news.value
        found = value - worker.scene.rng.uniform(-5.0, 5.0)
        trace.append((news and news.worker, found))
        if found < value:
            value = found
            worker.publish(value, placed(round(value * 1e6)))


def traces(pauses, workers=3):
    found: list[list[tuple[int | None, float]]] = [[] for _ in range(workers)]
    waits = [np.random.default_rng([pauses, k]) for k in range(workers)]
    best = run_workers(scene_for(workers), -np.inf, lambda w: walk(w, waits[w.number], found[w.number]))
    return found, best.items.tolist()


def test_workers_do_the_same_whatever_time_each_of_them_takes():
    one, other = traces(1), traces(2)
    assert one == other
    assert any(news is not None for news, _ in one[0][0])
    assert len({value for trace in one[0] for _, value in trace}) > len(one[0][0])


def test_the_layout_that_reaches_the_goal_with_least_work_is_returned_and_ends_the_search():
    def search(worker):
        worker.scene.budget.left -= (1 + worker.number) * DELAY / 10
        worker.publish(1.0 - worker.number, placed(worker.number))
        while not worker.over():
            worker.scene.budget.left -= DELAY / 10
            worker.knows_better(0.0)

    scene = scene_for(2)
    assert run_workers(scene, 5.0, search).items.tolist() == [0]
    assert scene.budget.spent < 2 * DELAY


def test_a_fault_in_one_worker_ends_all_and_is_raised():
    def search(worker):
        if worker.number == 1:
            raise ValueError("fault")
        while not worker.over():
            worker.knows_better(0.0)
            worker.scene.budget.left -= 1.0

    with pytest.raises(ValueError, match="fault"):
        run_workers(scene_for(work=20_000.0), -np.inf, search)


def test_a_worker_that_waits_for_another_ends_with_the_time():
    def search(worker):
        if worker.number == 0:
            time.sleep(0.3)
        worker.scene.budget.left -= 2 * DELAY
        worker.knows_better(0.0)

    begun = time.monotonic()
    run_workers(scene_for(stop=Stop.after(0.1)), -np.inf, search)
    assert time.monotonic() - begun < 5.0
