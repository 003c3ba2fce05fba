"""Contractions of a small solid, also where kernels run as plain Python."""

import pytest
from manifold3d import Manifold
from tests.shared.solids import arrays

from amprep.geometry.bounding.simplification.simplify_outwards import simplify_outwards
from amprep.geometry.meshes.manifold import as_manifold


@pytest.mark.parametrize("cost", ["volume", "distance"])
def test_a_coarse_ball_is_contained_within_the_limit(cost):
    ball = Manifold.sphere(5, 8)
    simplified = simplify_outwards(arrays(ball), 16, cost=cost, max_error=2.0)
    assert len(simplified.triangles) < ball.num_tri()
    assert (ball - as_manifold(simplified.vertices, simplified.triangles)).volume() == pytest.approx(
        0.0, abs=1e-9
    )
