"""Areas of cross-sections, against manifold3d."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.removal import ring
from tests.shared.solids import arrays

from amprep.geometry.slicing import cross_sections
from amprep.geometry.slicing.cross_sections import cross_section_areas


def corners_of(solid):
    vertices, triangles = arrays(solid)
    return vertices[triangles]


@examples(20)
@given(st.integers(0, 10**6))
def test_areas_are_those_of_the_slices_of_manifold3d(seed):
    rng = np.random.default_rng(seed)
    cube = Manifold.cube([30, 20, 25]) - ring((15, 10, 12), "y", radius=7, thickness=3)
    solid = cube.rotate(rng.uniform(0, 360, 3).tolist())
    _, _, low, _, _, high = solid.bounding_box()
    heights = np.sort(rng.uniform(low - 2, high + 2, 9))
    found = cross_section_areas(corners_of(solid), heights)
    np.testing.assert_allclose(found, [solid.slice(h).area() for h in heights], rtol=1e-6, atol=1e-6)


def test_planes_through_vertices_and_faces_count_one_side():
    cube = corners_of(Manifold.cube([2, 3, 4]))
    np.testing.assert_allclose(cross_section_areas(cube, np.array([0.0, 2.0, 4.0])), [0, 6, 6], atol=1e-12)


def test_triangles_are_cut_in_portions_with_the_same_result(monkeypatch: pytest.MonkeyPatch):
    solid = corners_of(Manifold.sphere(10, 40))
    heights = np.linspace(-9, 9, 50)
    whole = cross_section_areas(solid, heights)
    monkeypatch.setattr(cross_sections, "ROWS", 7)
    np.testing.assert_allclose(cross_section_areas(solid, heights), whole, rtol=1e-9)
