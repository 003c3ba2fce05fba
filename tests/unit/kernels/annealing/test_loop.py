"""The main loop of the annealing: after every accepted move, nothing intersects."""

import numpy as np
import pytest
from tests.shared.annealing import ENGINES, layout_of, search_of, shapes_problem

from amprep.checks.packing.volumes_placed import PlacedVolume
from amprep.kernels.annealing.loop import anneal, count_collisions
from amprep.kernels.annealing.records import ACCEPTED, BEST_OUTSIDE, BEST_TOP, DONE, OUTSIDE
from amprep.model import BuildVolume, Orientations, Stop, silent

SIZES = [(6, 4, 6), (5, 5, 8), (8, 3, 4), (4, 4, 4), (7, 6, 5), (3, 3, 9)]


def gaps(problem, placed):
    """Least distance of each pair of volumes, by manifold3d; negative where they overlap."""
    bodies = [PlacedVolume(problem, placement, fixed=False) for placement in placed.values()]
    limit = problem.clearance + 1.0
    return [a.gap(b, limit) for n, a in enumerate(bodies) for b in bodies[:n]]


def one_move(search):
    """Make one move and return whether it was accepted."""
    before = int(search.state.counts[ACCEPTED])
    anneal(search.shapes, search.scene, search.state, search.rules, 1)
    return int(search.state.counts[ACCEPTED]) > before


@pytest.mark.parametrize("freedom", ["list", "about-z", "free"])
@pytest.mark.parametrize("clearance", [0.0, 0.5])
@pytest.mark.parametrize("word", ENGINES)
def test_nothing_is_nearer_than_the_clearance_after_any_accepted_move(word, clearance, freedom):
    if word == "boxes" and freedom != "list":
        pytest.skip("boxes that turn are pieces")
    problem = shapes_problem(
        word, SIZES, orientations=Orientations(freedom), clearance=clearance, objective="height"
    )
    search = search_of(problem, temperature=0.5, drops=0.4, turns=0.3)
    accepted = 0
    while accepted < 25:
        if one_move(search):
            accepted += 1
            placed = layout_of(search, problem)
            assert min(gaps(problem, placed)) >= clearance - 1e-6
            assert count_collisions(search.shapes, search.scene, search.state) == 0


@pytest.mark.parametrize("schedule", ["geometric", "linear", "adaptive"])
def test_every_schedule_puts_all_items_into_a_roomy_build_as_in_the_thesis(schedule):
    """Without re-insertions, from outside, by random translations alone."""
    problem = shapes_problem("boxes", [(2, 2, 2)] * 4, room=(12, 12, 12), objective="fill")
    search = search_of(problem, lowers=False, schedule=schedule, drops=0.0, moves=3000)
    assert search.state.figures[OUTSIDE] == pytest.approx(4.0)
    search.run(Stop(), silent)
    assert search.inside.all()


def test_moves_in_several_calls_are_the_moves_of_one_call():
    problem = shapes_problem("boxes", SIZES, clearance=0.5, objective="height")
    one, other = search_of(problem), search_of(problem)
    anneal(one.shapes, one.scene, one.state, one.rules, 3000)
    for count in (1, 999, 1500, 500):
        anneal(other.shapes, other.scene, other.state, other.rules, count)
    assert (one.state.pose == other.state.pose).all()
    assert one.state.counts[DONE] == other.state.counts[DONE] == 3000


def test_the_best_layout_only_gets_lower():
    problem = shapes_problem("boxes", SIZES, objective="height")
    search = search_of(problem)
    ranks = []
    for _ in range(40):
        anneal(search.shapes, search.scene, search.state, search.rules, 200)
        ranks.append(tuple(np.round(search.state.figures[[BEST_OUTSIDE, BEST_TOP]], 9)))
    assert ranks == sorted(ranks, reverse=True)
    assert ranks[-1][1] < ranks[0][1] or ranks[0][0] > 0


@pytest.mark.parametrize("shape", ["box", "cylinder"])
@pytest.mark.parametrize("stacking", [True, False])
def test_the_best_layout_is_inside_the_build_volume(shape, stacking):
    space = BuildVolume(np.array([20.0, 20.0, 25.0]), shape)
    problem = shapes_problem(
        "pieces", SIZES, space=space, clearance=1.0, lift=2.0, stacking=stacking,
        orientations=Orientations("about-z"), objective="height",
    )  # fmt: skip
    search = search_of(problem, moves=200)
    search.run(Stop(), silent)
    assert search.inside.any()
    for placement in search.best():
        points = PlacedVolume(problem, placement, fixed=False).points
        assert points[:, 2].min() >= 2.0 - 1e-6
        assert points[:, 2].max() <= 24.0 + 1e-6
        if not stacking:
            assert points[:, 2].min() <= 2.0 + 1e-6
        if shape == "box":
            assert points[:, :2].min() >= 1.0 - 1e-6
            assert points[:, :2].max() <= 19.0 + 1e-6
        else:
            assert np.hypot(*(points[:, :2] - 10.0).T).max() <= 9.0 + 1e-6
