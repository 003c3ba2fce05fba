"""The packer `ip` against exhaustive search on tiny problems whose boxes have whole lengths."""

from functools import cache
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.examples import examples
from tests.shared.grids import Late

from amprep.checks.packing.volumes_placed import check_packing
from amprep.errors import AmprepError
from amprep.kernels.boxes.records import Arrangement
from amprep.model import (
    Boxes,
    BuildVolume,
    Item,
    Orientations,
    Packing,
    PackingProblem,
    Placement,
    Stop,
    silent,
)
from amprep.plugins.packers.bounds.combinatorial import packing_bound
from amprep.plugins.packers.extreme_points import construct
from amprep.plugins.packers.instance.arrangement import PackerResult
from amprep.plugins.packers.instance.prepare import prepare
from amprep.plugins.packers.integer_program import gap_of, pack_ip
from amprep.plugins.packers.integer_program.constraints import make_program
from amprep.plugins.packers.integer_program.data import count_directions, prepare_model_data
from amprep.plugins.packers.integer_program.decode import start_values
from amprep.plugins.packers.integer_program.solver import solve
from amprep.plugins.packers.params import ExtremePointsParams, IpParams

ROOM = 4
TURN_Z = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
TURNS = Orientations(matrices=np.array([np.eye(3), TURN_Z]))


def box(*size):
    return Boxes(np.zeros((1, 3)), np.array([size], float))


def problem(sizes, objective="fill", values=None, room=(ROOM, ROOM, ROOM), **rules):
    values = values or [float(np.prod(size)) for size in sizes]
    items = tuple(Item(i, 0, box(*size), values[i]) for i, size in enumerate(sizes))
    return PackingProblem(items, BuildVolume(np.array(room, float)), objective, **rules)


def run(given_problem, stop=None, **params):
    rng = np.random.default_rng(1)
    packing = pack_ip(given_problem, params=IpParams(**params), rng=rng, stop=stop or Stop(), progress=silent)
    assert check_packing(given_problem, packing) == []
    return packing


def value(given_problem, packing):
    return sum(given_problem.items[p.item].value for build in packing.builds for p in build)


@cache
def fits(sizes, room=ROOM):
    """Whether boxes fit a cube, by trying every whole position of each in turn."""

    def place(number, taken):
        if number == len(sizes):
            return True
        size = sizes[number]
        for corner in product(*(range(room - s + 1) for s in size)):
            spot = tuple(slice(c, c + s) for c, s in zip(corner, size, strict=True))
            if not taken[spot].any():
                taken[spot] = True
                if place(number + 1, taken):
                    return True
                taken[spot] = False
        return False

    return sum(a * b * c for a, b, c in sizes) <= room**3 and place(0, np.zeros((room,) * 3, bool))


def greatest_value(sizes, values):
    subsets = (s for n in range(len(sizes) + 1) for s in combinations(range(len(sizes)), n))
    return max(sum(values[i] for i in s) for s in subsets if fits(tuple(sorted(sizes[i] for i in s))))


def fewest_builds(sizes):
    """Put the items into groups one after another; the least number of groups that all fit."""

    def groupings(rest):
        if not rest:
            yield []
            return
        for groups in groupings(rest[1:]):
            yield [[rest[0]], *groups]
            for i, group in enumerate(groups):
                yield [*groups[:i], [rest[0], *group], *groups[i + 1 :]]

    return min(len(g) for g in groupings(list(sizes)) if all(fits(tuple(sorted(group))) for group in g))


side = st.integers(1, ROOM)
some_sizes = st.lists(st.tuples(side, side, side), min_size=1, max_size=5)
switches = st.fixed_dictionaries({name: st.booleans() for name in ("sharing", "symmetry", "tighten")})


@examples(60)
@given(some_sizes, st.lists(st.integers(0, 9), min_size=5, max_size=5), switches)
def test_a_fill_problem_is_solved_to_the_greatest_value_whatever_the_options(sizes, values, options):
    given_problem = problem(sizes, values=[float(v) for v in values])
    packing = run(given_problem, effort=10.0, **options)
    assert packing.status == "optimal"
    assert value(given_problem, packing) == greatest_value(sizes, values)


@examples(60)
@given(some_sizes, switches)
def test_a_builds_problem_is_solved_to_the_fewest_builds_whatever_the_options(sizes, options):
    packing = run(problem(sizes, "builds"), effort=10.0, **options)
    assert packing.status == "optimal"
    assert len(packing.builds) == packing.bound == fewest_builds(sizes)


@pytest.mark.parametrize("sharing", [True, False])
def test_alternative_copies_turn_an_item_that_fits_only_turned(sharing):
    # three bars of 4 x 1 in a room of 3 x 4: all must be turned; a fourth of 2 x 1 finds no position
    bars = [Item(i, 0, box(4, 1, 1), 4.0, TURNS) for i in range(3)] + [Item(3, 0, box(2, 1, 1), 1.0)]
    given_problem = PackingProblem(tuple(bars), BuildVolume(np.array([3.0, 4.0, 1.0])), "fill")
    packing = run(given_problem, sharing=sharing, effort=10.0)
    assert (value(given_problem, packing), packing.status) == (12.0, "optimal")
    assert [unplaced.item for unplaced in packing.unplaced] == [3]


def test_boxes_of_one_item_keep_their_relative_position():
    # two L of three unit cubes each make a 2 x 3 x 1 slab only when they interlock
    one = Boxes(np.array([[0.0, 0, 0], [0, 1, 0]]), np.array([[2.0, 1, 1], [1, 2, 1]]))
    other = Boxes(np.array([[1.0, 0, 0], [0, 1, 0]]), np.array([[2.0, 1, 1], [2, 2, 1]]))
    items = (Item(0, 0, one, 3.0), Item(1, 0, other, 3.0))
    given_problem = PackingProblem(items, BuildVolume(np.array([2.0, 3.0, 1.0])), "builds")
    packing = run(given_problem)
    assert (len(packing.builds), packing.status) == (1, "optimal")


def test_a_zone_takes_its_room_away():
    # a zone over half the plate, up to the lid: of two halves only one finds a position
    half = [(2, 4, 4), (2, 4, 4)]
    items = problem(half).items
    space = BuildVolume(np.full(3, 4.0), "box", np.array([[2.0, 0, 0]]), np.array([[4.0, 4, 9]]))
    packing = run(PackingProblem(items, space, "fill"), effort=10.0)
    assert (len(packing.builds[0]), packing.status) == (1, "optimal")
    assert len(run(PackingProblem(items, space, "builds")).builds) == 2


@pytest.mark.parametrize("objective", ["fill", "builds"])
def test_what_stands_already_stays_in_the_first_build(objective):
    # a cube of 2 fixed in the middle of a room of 4 leaves no position for a slab of 4 x 4 x 2
    sizes = [(2, 2, 2), (4, 4, 2), (1, 1, 1)]
    fixed = (Placement(0, np.eye(3), np.ones(3)),)
    packing = run(problem(sizes, objective, fixed=fixed), effort=10.0)
    assert packing.status == "optimal"
    if objective == "fill":
        assert {p.item for p in packing.builds[0]} == {0, 2}
    else:
        assert [{p.item for p in build} >= {0} for build in packing.builds] == [True, False]


def test_without_stacking_all_stand_at_the_lift():
    given_problem = problem([(2, 4, 1)] * 4, lift=1.0, stacking=False, values=[1.0, 2.0, 3.0, 4.0])
    packing = run(given_problem)
    assert (value(given_problem, packing), packing.status) == (7.0, "optimal")


def test_clearance_is_kept():
    # 1.5 + 1 + 1.5 = 4, and 1 from both walls: a room of 6 just holds two in a row
    given_problem = problem([(1.5, 4, 4)] * 3, "builds", room=(6.0, 6, 6), clearance=1.0)
    packing = run(given_problem)
    assert len(packing.builds) == 2
    assert packing.bound <= 2


@pytest.mark.parametrize(("objective", "seed"), [("fill", 4), ("fill", 13), ("builds", 41), ("builds", 124)])
def test_with_clearance_the_program_proves_what_the_combinatorial_bounds_do_not(objective, seed):
    sizes = np.random.default_rng(seed).integers(3, 7, (6, 3)).tolist()
    given_problem = problem(sizes, objective, room=(13.0, 13, 13), clearance=1.0)
    packing = run(given_problem)
    assert packing.status == "optimal"
    assert packing.bound != packing_bound(prepare(given_problem))


@pytest.mark.parametrize("objective", ["fill", "builds"])
@pytest.mark.parametrize(("apart", "axes"), [(0.75, 2), (0.6, 3)])
def test_with_clearance_the_bound_admits_boxes_that_are_apart_at_their_corners(objective, apart, axes):
    # two boxes of 4 in a room where they keep 1 mm only across: 0.75 * sqrt(2) and 0.6 * sqrt(3) are above 1
    room = [8.0 + apart + 2.0] * axes + [6.0] * (3 - axes)
    given_problem = problem([(4, 4, 4)] * 2, objective, room=tuple(room), clearance=1.0)
    far = np.array([5.0 + apart] * axes + [1.0] * (3 - axes))
    across = (Placement(0, np.eye(3), np.ones(3)), Placement(1, np.eye(3), far))
    packing = run(given_problem)
    claimed = Packing((across,), bound=packing.bound)
    assert check_packing(given_problem, claimed) == []


def corner_layout(seed, clearance):
    """Boxes, each near a corner, an edge or a face of an earlier one, with the tightest room for them."""
    rng = np.random.default_rng(seed)
    sizes = rng.integers(1, 5, (int(rng.integers(2, 5)), 3)).astype(float)
    at = [np.zeros(3)]
    for number in range(1, len(sizes)):
        near = int(rng.integers(number))
        gap = np.abs(rng.normal(size=3)) * (rng.random(3) < 0.8)
        gap = gap * clearance / np.linalg.norm(gap) if gap.any() else np.array([clearance, 0.0, 0.0])
        beyond = np.where(rng.random(3) < 0.5, sizes[near] + gap, -sizes[number] - gap)
        at.append(at[near] + np.where(gap > 0.0, beyond, rng.uniform(-0.5, 0.5, 3) * sizes[near]))
    lo, hi = np.min(at, axis=0), np.max(at + sizes, axis=0)
    room = tuple(hi - lo + [2 * clearance, 2 * clearance, clearance])
    return sizes.tolist(), room, np.array(at) - lo + [clearance, clearance, 0.0]


@pytest.mark.parametrize("objective", ["fill", "builds"])
def test_no_layout_that_keeps_the_clearance_across_corners_beats_the_bound(objective):
    judged = 0
    for seed in range(60):
        sizes, room, positions = corner_layout(seed, 1.0)
        given_problem = problem(sizes, objective, room=room, clearance=1.0)
        layout = tuple(Placement(i, np.eye(3), position) for i, position in enumerate(positions))
        if not check_packing(given_problem, Packing((layout,))):
            bound = run(given_problem).bound
            assert check_packing(given_problem, Packing((layout,), bound=bound)) == []
            judged += 1
    assert judged > 30


@examples(80)
@given(st.lists(st.tuples(side, side, side), min_size=2, max_size=2), st.floats(0.0, 2.0), st.data())
def test_boxes_that_the_judge_accepts_are_as_far_apart_as_the_relaxed_program_demands(sizes, gap, data):
    given_problem = problem(sizes, room=(7.0, 7.5, 9.0), clearance=gap)
    instance = prepare(given_problem)
    ends = [(instance.space.lo, instance.space.hi - size) for size in np.array(sizes, float)]
    if not instance.free.all():
        return
    at = [[data.draw(st.floats(a, max(a, b))) for a, b in zip(lo, hi, strict=True)] for lo, hi in ends]
    placed = tuple(Placement(i, np.eye(3), np.array(position)) for i, position in enumerate(at))
    if check_packing(given_problem, Packing((placed,))):
        return
    (pair,) = prepare_model_data(instance, 1, IpParams(symmetry=False), Stop(), relaxed=True).pairs
    lo = np.array([at[pair.one.copy], at[pair.other.copy]])
    hi = lo + np.array(sizes, float)[[pair.one.copy, pair.other.copy]]
    apart = np.stack((lo[1] - hi[0], lo[0] - hi[1]), axis=1).ravel()
    assert (pair.possible & (apart >= np.repeat(pair.required, 2) - 1e-9)).any()


def test_a_stop_ends_the_building_of_the_model_at_once_and_the_solver_does_not_run():
    given_problem = problem(np.random.default_rng(2).integers(1, 4, (30, 3)).tolist(), room=(6.0, 6, 6))
    instance, params = prepare(given_problem), IpParams()

    def build(stop):
        data = prepare_model_data(instance, 1, params, stop)
        return make_program(data, params, stop)

    whole, asked = build(endless := Late(10**9)), endless.asked
    for number in np.linspace(0, asked - 1, 12).astype(int).tolist():
        program, variables = build(stop := Late(number))
        assert program.numConstraints() + len(variables.direction) < whole[0].numConstraints() + 435
        outcome = solve(program, params, nodes=10, stop=stop, progress=silent)
        assert (outcome.status, outcome.solved, outcome.stop_reason) == ("stopped", False, "time limit")
        assert stop.asked <= number + 5


def test_the_result_says_who_found_it_and_whether_the_solver_ran():
    sizes = np.random.default_rng(4).integers(2, 6, (10, 3)).tolist()
    given_problem = problem(sizes, room=(9.0, 9, 9))
    assert run(given_problem, directions=0).found_by.endswith("; the solver did not run")
    assert run(given_problem, start="none").found_by == "the solver HiGHS"
    assert run(problem([(4, 4, 4)])).found_by == "extreme points; the solver did not run"


def test_an_item_that_fits_no_build_is_named_and_the_rest_packed():
    packing = run(problem([(5, 1, 1), (4, 4, 3), (4, 4, 2)], "builds"))
    assert (packing.status, len(packing.builds)) == ("infeasible", 2)
    assert [(u.item, u.reason) for u in packing.unplaced] == [(0, "too large")]


def test_a_model_beyond_the_limit_is_not_built():
    sizes = [(2, 2, 3)] * 6 + [(3, 3, 2)] * 3
    given_problem = problem(sizes)
    needed = count_directions(prepare(given_problem), IpParams())
    assert needed == 6 * 36  # nine boxes, 36 pairs, six directions
    packing = run(given_problem, directions=needed - 1)
    assert packing.stop_reason == "model too large: 216 direction variables, at most 215"
    assert packing.status == "feasible"


def test_the_plain_model_has_the_size_that_the_thesis_counts():
    # 4n + 6 C(n, 2) variables and 7 C(n, 2) constraints; once() adds one for each item
    instance, n = prepare(problem([(1, 2, 3), (2, 2, 3), (3, 2, 1), (1, 1, 4), (2, 3, 3)])), 5
    params = IpParams(sharing=False, symmetry=False, tighten=False)
    program, _ = make_program(prepare_model_data(instance, 1, params, Stop()), params, Stop())
    assert program.numVariables() == 4 * n + 6 * 10
    assert program.numConstraints() == 7 * 10 + n


@examples(40)
@given(some_sizes, switches, st.booleans())
def test_a_heuristics_packing_satisfies_the_program_as_its_start(sizes, options, equal):
    given_problem = problem(sizes * 2 if equal else sizes)
    params, instance = IpParams(**options), prepare(given_problem)
    rng = np.random.default_rng(1)
    known = construct(instance, params=ExtremePointsParams(), rng=rng, stop=Stop(), progress=silent)
    data = prepare_model_data(instance, 1, params, Stop())
    program, variables = make_program(data, params, Stop())
    for variable, number in start_values(data, variables, known.arrangement, Stop()).items():
        variable.varValue = number
    assert [c.name for c in program.constraints() if not c.valid(1e-6)] == []


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # pulp names its own successor of CBC
def test_another_solver_of_pulp_finds_the_same():
    pulp = pytest.importorskip("pulp")
    if "PULP_CBC_CMD" not in pulp.listSolvers(onlyAvailable=True):
        pytest.skip("CBC is not installed")
    sizes = [(2, 3, 3), (3, 2, 2), (4, 1, 3), (1, 4, 4)]
    packing = run(problem(sizes), solver="PULP_CBC_CMD")
    assert packing.status == "optimal"
    assert value(problem(sizes), packing) == greatest_value(sizes, [float(np.prod(s)) for s in sizes])


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # pulp names its own successor of CBC
@pytest.mark.parametrize("name", ["HIGS", "XPRESS_PY"])
def test_a_solver_that_pulp_does_not_know_or_that_is_not_installed_is_one_line(name):
    sizes = [(2, 3, 3), (3, 2, 2), (4, 1, 3), (1, 4, 4)]
    with pytest.raises(AmprepError, match=name):
        run(problem(sizes), solver=name)


def test_the_same_problem_gives_the_same_packing_within_a_budget_of_nodes():
    rng = np.random.default_rng(5)
    given_problem = problem(rng.integers(2, 6, (14, 3)).tolist(), room=(9, 9, 9))
    one, other = run(given_problem, effort=0.01), run(given_problem, effort=0.01)
    assert [p.matrix.tolist() for p in one.builds[0]] == [p.matrix.tolist() for p in other.builds[0]]
    assert one.bound == other.bound >= value(given_problem, one)


def test_a_gap_is_the_distance_to_the_bound_as_a_fraction_of_it():
    instance = prepare(problem([(4, 4, 3), (4, 4, 3)], "builds"))
    one_in_each = Arrangement(np.array([0, 1]), np.array([0, 0]), np.zeros((2, 3)))
    assert gap_of(instance, PackerResult(one_in_each, 2.0, "finished")) == 0.0
    assert gap_of(instance, PackerResult(one_in_each, 1.0, "finished")) == 1.0


@pytest.mark.parametrize("wrong", [{"effort": -1.0}, {"threads": 0}, {"directions": -1}, {"seed": -1}])
def test_a_parameter_out_of_bounds_is_refused_by_name(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        IpParams(**wrong)
