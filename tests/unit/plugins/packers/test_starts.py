"""Several searches side by side: the best packing counts, and processes change nothing."""

import os
import time
from dataclasses import dataclass
from threading import Timer

import numpy as np
import pytest
from tests.shared.boxes import boxes_problem

from amprep.checks.packing.volumes_placed import check_packing
from amprep.errors import JobError
from amprep.host import Host
from amprep.model import Packing, Stop, silent
from amprep.model.packing import Placement
from amprep.plugins.packers.params import ExtremePointsParams
from amprep.plugins.packers.starts import with_starts
from amprep.workers import allowed

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="workers are forked")

PROBLEM = boxes_problem([(4.0, 4.0, 4.0)] * 4, (10.0, 10.0, 10.0))


@dataclass(frozen=True)
class Params:
    starts: int = 1


def in_builds(count, **claims):
    """The cubes of the problem in so many builds, one after another."""
    builds: list[list[Placement]] = [[] for _ in range(count)]
    for item in range(4):
        place = (
            np.array([4.0 * (item // count), 0.0, 0.0])
            if count > 1
            else np.array([4.0 * (item % 2), 4.0 * (item // 2), 0])
        )
        builds[item % count].append(Placement(item, np.eye(3), place))
    return Packing(tuple(map(tuple, builds)), **claims)


def searching(problem, *, params, rng, stop, progress):
    """Choose one to four builds at random, and say which process did."""
    assert params.starts == 1
    progress(0.5, "searching")
    return in_builds(int(rng.integers(2, 5)), found_by=str(os.getpid()))


def run(pack, starts, *, workers=1, stop=None, progress=silent, seed=3, problem=PROBLEM):
    with allowed(workers):
        return with_starts(pack)(
            problem,
            params=Params(starts),
            rng=np.random.default_rng(seed),
            stop=stop or Stop(),
            progress=progress,
        )


def test_one_start_is_the_packer_itself():
    alone = searching(PROBLEM, params=Params(), rng=np.random.default_rng(3), stop=Stop(), progress=silent)
    assert len(run(searching, 1).builds) == len(alone.builds)


@pytest.mark.parametrize("seed", range(4))
def test_more_starts_are_never_worse_and_find_the_same_with_any_number_of_processes(seed):
    sizes = [len(run(searching, starts, seed=seed).builds) for starts in (1, 2, 4, 8)]
    assert sizes == sorted(sizes, reverse=True)
    assert len(run(searching, 8, seed=seed, workers=3).builds) == sizes[-1]


def test_starts_are_done_by_other_processes_where_several_are_allowed():
    assert run(searching, 3).found_by == str(os.getpid())
    assert run(searching, 3, workers=2).found_by != str(os.getpid())


@pytest.mark.parametrize("workers", [1, 3])
def test_after_a_proof_later_starts_do_not_count(workers):
    flat = boxes_problem([(4.0, 4.0, 4.0)] * 4, (10.0, 10.0, 10.0), stacking=False)

    def second_proves(problem, *, params, rng, stop, progress):
        number = 0 if rng is first else 1
        if number == 0:
            time.sleep(0.05)
            return in_builds(2)
        return in_builds(1, status="optimal", found_by="proof")

    first = np.random.default_rng(0)
    with allowed(workers):
        found = with_starts(second_proves)(flat, params=Params(5), rng=first, stop=Stop(), progress=silent)
    assert found.found_by == "proof"


def test_lower_builds_win_among_as_many():
    def high_or_low(problem, *, params, rng, stop, progress):
        packing = in_builds(2)
        if rng is first:
            lifted = tuple(
                Placement(p.item, p.rotation, p.translation + (0, 0, 5)) for p in packing.builds[0]
            )
            return Packing((lifted, packing.builds[1]))
        return packing

    first = np.random.default_rng(0)
    found = with_starts(high_or_low)(PROBLEM, params=Params(2), rng=first, stop=Stop(), progress=silent)
    assert found.builds[0][0].translation[2] == 0.0


def test_starts_one_after_another_share_the_time():
    left = []

    def asked(problem, *, params, rng, stop, progress):
        left.append(stop.remaining())
        return in_builds(2)

    run(asked, 4, stop=Stop.after(100.0))
    assert np.allclose(left, [25.0, 33.3, 50.0, 100.0], atol=0.5)


def test_an_interruption_reaches_every_process_and_the_best_so_far_is_kept():
    def until_told(problem, *, params, rng, stop, progress):
        while not stop():
            time.sleep(0.01)
        return in_builds(3)

    stop = Stop()
    timer = Timer(0.2, stop.cancelled.set)
    timer.start()
    began = time.monotonic()
    found = run(until_told, 4, workers=2, stop=stop)
    timer.join()
    assert len(found.builds) == 3
    assert time.monotonic() - began < 5.0


def test_the_progress_is_that_of_all_starts():
    seen = []
    run(searching, 4, progress=lambda fraction, message: seen.append((fraction, message)))
    fractions = [fraction for fraction, _ in seen]
    assert fractions == sorted(fractions)
    assert (0.125, "start 1 of 4: searching") in seen
    assert (0.875, "start 4 of 4: searching") in seen


def test_the_answer_of_a_built_in_packer_is_judged_and_the_same_in_one_and_in_two_processes():
    sizes = np.random.default_rng(5).uniform(1.0, 6.0, (14, 3)).tolist()
    problem, host = boxes_problem(sizes, (10.0, 10.0, 10.0)), Host.load(plugins_enabled=False)
    packer = host.choose("packer", "extreme-points")
    params = host.params(packer, {"starts": 3, "restarts": 3})
    found = []
    for workers in (1, 2):
        with allowed(workers):
            packing = host.call(
                packer, problem, params=params, rng=np.random.default_rng(1), stop=Stop(), progress=silent
            )
        assert check_packing(problem, packing) == []
        found.append([(p.item, p.translation.tolist()) for build in packing.builds for p in build])
    assert found[0] == found[1]


@pytest.mark.parametrize("name", ["auto", "separation", "plates", "annealing", "extreme-points"])
def test_packers_that_search_take_starts_and_refuse_none(name):
    host = Host.load(plugins_enabled=False)
    packer = host.choose("packer", name)
    extra = {"restarts": 1} if name == "extreme-points" else {}
    assert host.params(packer, {"starts": 2, **extra}).starts == 2
    with pytest.raises(JobError, match="starts"):
        host.params(packer, {"starts": 0, **extra})


def test_orderings_without_random_numbers_are_not_searched_twice():
    with pytest.raises(ValueError, match="restarts"):
        ExtremePointsParams(starts=2)
