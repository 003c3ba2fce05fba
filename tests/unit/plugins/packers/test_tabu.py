"""The tabu search is the thesis's: where boxes may stand, what a move is, when it ends."""

import numpy as np
import pytest
from tests.shared.boxes import boxes_problem as problem

from amprep.checks.packing.volumes_placed import check_packing
from amprep.errors import PluginError
from amprep.host import Host
from amprep.model import BuildVolume, PackingProblem, Stop, silent
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.params import TabuParams
from amprep.plugins.packers.tabu import TabuSearch, pack_tabu
from amprep.testing.packing_instances import mpv_instance


def run(task, stop=None, **params):
    packing = pack_tabu(
        task, params=TabuParams(**params), rng=np.random.default_rng(0), stop=stop or Stop(), progress=silent
    )
    assert check_packing(task, packing) == []
    return packing


def test_the_sub_heuristic_puts_a_box_where_it_touches_most():
    # 10 x 10 x 4 fills the floor, 10 x 6 x 6 lies on it in the corner, 10 x 4 x 6 fills the rest
    search = TabuSearch(
        prepare(problem([(10, 10, 4), (10, 6, 6), (10, 4, 6)])), TabuParams(start="heuristic")
    )
    assert search.current.build.tolist() == [0, 0, 0]
    assert search.current.position.tolist() == [[0, 0, 0], [0, 0, 4], [0, 6, 4]]


def test_every_box_has_a_wall_or_a_box_below_left_and_behind():
    rng = np.random.default_rng(2)
    task = problem(rng.integers(1, 6, (25, 3)).tolist())
    search = TabuSearch(prepare(task), TabuParams(start="heuristic"))
    sizes, position, build = (
        [item.volume.hi[0] for item in task.items],
        search.current.position,
        search.current.build,
    )
    for i, size in enumerate(sizes):
        for axis in range(3):
            across = [a for a in range(3) if a != axis]
            touched = position[i, axis] == 0.0
            for j, other in enumerate(sizes):
                shared = np.minimum(position[i] + size, position[j] + other) - np.maximum(
                    position[i], position[j]
                )
                meets = position[j, axis] + other[axis] == position[i, axis] and (shared[across] > 0).all()
                touched |= bool(build[j] == build[i] and meets)
            assert touched


def test_it_starts_with_every_item_in_its_own_build():
    search = TabuSearch(prepare(problem([(5, 5, 5)] * 4)), TabuParams())
    assert sorted(search.current.build.tolist()) == [0, 1, 2, 3]


def test_one_search_moves_one_item_out_of_the_emptiest_build():
    search = TabuSearch(prepare(problem([(9, 9, 9), (5, 5, 4), (5, 5, 5), (6, 6, 6)])), TabuParams())
    assert search.target == search.current.build[1]
    assert search.search(Stop())
    # item 1 was alone and fits beside item 2 or 3, in the order of the builds: one build less
    assert search.current.build.max() == 2
    assert search.k == 1


def test_diversifying_aims_at_the_next_emptiest_build_and_at_last_takes_the_emptier_half_apart():
    # nothing fits beside anything else
    search = TabuSearch(
        prepare(problem([(9, 9, 9), (8, 8, 8), (7, 7, 7), (6, 6, 6)])), TabuParams(max_diversifications=2)
    )
    targets = [search.target]
    for _ in range(2):
        search.diversify()
        targets.append(search.target)
    assert targets == [3, 2, 1]
    search.diversify()
    assert (search.d, search.target) == (0, search.current.build[3])


def test_halves_are_brought_together_and_the_bound_proves_it():
    packing = run(problem([(10, 10, 5)] * 6 + [(5, 10, 10)] * 4))
    assert len(packing.builds) == 5
    assert (packing.status, packing.bound, packing.stop_reason) == ("optimal", 5.0, "bound met")


def test_options_are_kept_and_bad_ones_refused():
    task = problem(np.random.default_rng(5).integers(2, 8, (20, 3)).tolist())
    for params in ({"start": "heuristic"}, {"max_tuple_size": 1}, {"tenure": 0}, {"count_weight": 0.2}):
        assert run(task, work=5.0, **params).status in {"optimal", "feasible"}
    for params in (
        {"start": "x"},
        {"max_tuple_size": 0},
        {"max_diversifications": -1},
        {"work": float("nan")},
    ):
        with pytest.raises(ValueError, match=next(iter(params))):
            TabuParams(**params)


def test_the_work_ends_the_search_at_the_same_place_every_time():
    task = problem(np.random.default_rng(6).integers(2, 8, (30, 3)).tolist())
    one, other = run(task, work=3.0), run(task, work=3.0)
    assert [[p.item for p in b] for b in one.builds] == [[p.item for p in b] for b in other.builds]
    assert one.stop_reason in {"work used up", "bound met", "no better one found"}


def test_stopped_at_once_it_still_places_all():
    packing = run(problem([(5, 5, 5)] * 10), Stop.after(0.0))
    assert sum(map(len, packing.builds)) == 10


def test_a_round_plate_is_refused_with_the_names_of_others():
    host = Host.load()
    listed = host.choose("packer", "tabu")
    task = PackingProblem((), BuildVolume(np.full(3, 10.0), "cylinder"))
    with pytest.raises(PluginError, match="extreme-points"):
        host.refuse_mismatch(listed, task)


def test_without_work_the_start_is_the_result():
    packing = run(mpv_instance(1, 30, 2).problem, work=0)
    assert (packing.stop_reason, len(packing.unplaced)) == ("work used up", 0)
