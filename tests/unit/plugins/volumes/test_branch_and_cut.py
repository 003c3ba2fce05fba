import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.coverings import part_of

from amprep.checks.volumes import check_volume
from amprep.model import Boxes, Mesh, Part, Stop
from amprep.plugins.volumes.branch_and_cut import branch_and_cut_boxes, cover_part
from amprep.plugins.volumes.params import BranchAndCutParams


def covered(part, stop=None, **settings):
    params = BranchAndCutParams(**settings)
    made = branch_and_cut_boxes(part, params=params, rng=np.random.default_rng(0), stop=stop or Stop())
    assert check_volume(part, made) == []
    assert isinstance(made.volume, Boxes)
    return made


def ring():
    return part_of((Manifold.cylinder(8, 20, 20, 48) - Manifold.cylinder(8, 14, 14, 48)).rotate([20, 0, 0]))


def test_more_work_raises_the_bound_until_the_gap_is_closed():
    gaps = [covered(ring(), work=work, cells=10).gap for work in (0.0, 0.6, 200.0)]
    assert gaps[0] > gaps[-1] == 0
    assert sorted(gaps, reverse=True) == gaps


@pytest.mark.parametrize("boxes", [2, 3, 4])
def test_there_are_no_more_boxes_than_asked_for(boxes):
    assert len(covered(ring(), boxes=boxes).volume.lo) <= boxes


def test_a_stop_ends_the_search_with_boxes_that_contain_the_part():
    assert covered(ring(), Stop.after(0.0)).gap > 0


def test_the_covering_of_a_part_tells_its_bound():
    cover = cover_part(ring(), BranchAndCutParams(work=200.0, cells=10), np.random.default_rng(0), Stop())
    assert cover.bound == cover.cells_volume
    assert cover.volume <= cover.cells_volume


def test_a_surface_that_is_no_solid_is_covered():
    vertices = np.random.default_rng(0).random((60, 3)) * 20
    covered(Part("part", Mesh(vertices, np.arange(60).reshape(-1, 3)), 0.0, is_solid=False))
