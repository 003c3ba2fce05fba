"""Implicit functions become closed meshes whose copies weld."""

import numpy as np
import pytest
from tests.shared.cells import sheared, tiled

from amprep.geometry.cells.implicit import implicit_solid
from amprep.geometry.meshes.manifold import as_manifold


def ball(points):
    """A ball in the middle of the cell and all its neighbours, touching them."""
    return 0.55 - np.linalg.norm(np.mod(points, 1.0) - 0.5, axis=1)


def test_a_function_is_meshed_up_to_the_sides_and_its_copies_weld():
    arrays = implicit_solid(ball, 20)
    cap = np.pi * 0.05**2 * (3 * 0.55 - 0.05) / 3
    assert as_manifold(*arrays).volume() == pytest.approx(4 / 3 * np.pi * 0.55**3 - 6 * cap, rel=0.01)
    assert len(tiled(arrays, sheared())) == 1


@pytest.mark.parametrize("wrong", [lambda points: points, lambda points: points[:, 0] * np.nan])
def test_a_function_that_gives_no_numbers_is_refused(wrong):
    with pytest.raises(ValueError, match="one finite number for each of"):
        implicit_solid(wrong, 8)
