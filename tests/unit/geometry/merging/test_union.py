"""Finished solids: without degenerate triangles, and in the shape that they had."""

import numpy as np
import pytest
from manifold3d import Manifold

from amprep.geometry.merging import union
from amprep.geometry.merging.union import FILE_STEP, finish
from amprep.geometry.meshes.manifold import as_manifold


class Simplifier:
    """A solid that loses volume where it is simplified by more than a tolerance, as manifold3d does at needles."""

    def __init__(self, most: float, volume: float = 1.0, used: float = 0.0) -> None:
        self.most, self.used, self._volume = most, used, volume

    def simplify(self, tolerance: float) -> "Simplifier":
        return Simplifier(self.most, 1.0 if tolerance <= self.most else 0.9, tolerance)

    def volume(self) -> float:
        return self._volume


@pytest.mark.parametrize(("most", "used"), [(1.0, FILE_STEP), (1e-5, 1e-6), (5e-7, 1e-7)])
def test_the_largest_tolerance_that_keeps_the_volume_is_taken(most, used):
    assert union._simplified(Simplifier(most)).used == used


def test_finished_solids_keep_their_volume_and_have_no_degenerate_triangles():
    half = Manifold.cube((2.0, 2.0, 4.0)) - Manifold.cylinder(9.0, 1.3, 1.3, 301).translate((2.2, 2.1, -1.0))
    whole = half + half.mirror((1, 0, 0)).translate((0.0, 1.0, 0.0))
    points, triangles = finish([whole])
    assert as_manifold(points, triangles).volume() == pytest.approx(whole.volume(), abs=1e-3)
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.linalg.norm(normal, axis=1) > 0.0).all()
