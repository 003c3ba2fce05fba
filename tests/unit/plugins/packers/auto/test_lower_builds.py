"""Each build of a packing is packed again, as low as possible."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.solids import volume_of_solid

from amprep.model import BuildVolume, Item, Orientations, Packing, PackingProblem, Placement, Stop
from amprep.plugins.packers.auto import pack_boxes
from amprep.plugins.packers.auto.lower_builds import heights_of, lower_builds
from amprep.plugins.packers.params import AutoParams

PYRAMID = volume_of_solid(Manifold.cylinder(20.0, 10.0, 0.0, 4))


def two_builds():
    """A pyramid on the plate of the first build, and one 15 mm above that of the second."""
    items = tuple(Item(0, copy, PYRAMID, 1.0, Orientations(), exact=True) for copy in range(2))
    problem = PackingProblem(items, BuildVolume(np.array([25.0, 25.0, 50.0])))
    builds = tuple(
        (Placement(item, np.eye(3), np.array([12.0, 12.0, height])),)
        for item, height in enumerate((0.0, 15.0))
    )
    return problem, Packing(builds, (), excess={0: 0.5, 1: 0.25})


def lowered(problem, packing, stop):
    return lower_builds(problem, packing, pack_boxes, AutoParams(), np.random.default_rng(1), stop)


def test_a_build_that_is_higher_than_its_parts_is_lowered_and_one_at_its_bound_stays():
    problem, packing = two_builds()
    found = lowered(problem, packing, Stop())
    assert heights_of(problem, packing) == pytest.approx([20.0, 35.0])
    assert heights_of(problem, found) == pytest.approx([20.0, 20.0])
    assert found.builds[0] == packing.builds[0]


def test_only_builds_that_stay_as_pieces_keep_the_excess_of_their_pieces():
    problem, packing = two_builds()
    assert lowered(problem, packing, Stop()).excess == {0: 0.5}, "the second build was packed as boxes"


def test_nothing_changes_without_time():
    problem, packing = two_builds()
    assert lowered(problem, packing, Stop.after(0.0)) is packing
