"""Decimated meshes are closed, have the same genus, are near the original, and keep locked vertices."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples

from amprep.checks.cells.ports import port_areas
from amprep.geometry.cells.implicit import implicit_solid
from amprep.geometry.merging.union import arrays_of
from amprep.geometry.meshes.decimation import decimate
from amprep.geometry.meshes.manifold import as_manifold
from amprep.model import Mesh, Template

FREE = np.zeros(100_000, np.int64)


def test_a_finely_divided_box_keeps_hardly_more_than_its_corners():
    points, triangles = arrays_of(Manifold.cube([1.0, 1.0, 1.0]).refine(5))
    corner = np.isin(points, (0.0, 1.0)).all(axis=1)
    own = np.where(corner, 1 << np.cumsum(corner), 0)  # a plane for each corner, so that all of them stay
    thin = decimate(points, triangles, 1e-9, own)
    assert len(thin[0]) <= 12 < len(points)
    assert as_manifold(*thin).volume() == pytest.approx(1.0)


@given(st.floats(0.002, 0.05), st.integers(24, 48))
@examples(6)
def test_a_ring_stays_a_ring_of_about_its_volume(tolerance, segments):
    ring = Manifold.cylinder(0.5, 1.0, 1.0, segments) - Manifold.cylinder(0.5, 0.5, 0.5, segments)
    points, triangles = arrays_of(ring.refine(2))
    thin = as_manifold(*decimate(points, triangles, tolerance, FREE[: len(points)]))
    assert thin.status().name == "NoError"
    assert thin.genus() == 1
    assert thin.num_tri() < len(triangles)
    assert thin.volume() == pytest.approx(ring.volume(), abs=4 * tolerance * ring.surface_area())


def test_locked_vertices_stay():
    points, triangles = arrays_of(Manifold.sphere(1.0, 32))
    upper = points[:, 2] >= 0.0
    thin, _ = decimate(points, triangles, 0.05, upper.astype(np.int64))
    assert set(map(tuple, points[upper])) <= set(map(tuple, thin))
    assert len(thin) < len(points)


def test_an_implicit_cell_has_the_sides_it_would_have_anyway_and_the_handles_of_its_surface():
    def tubes(points):
        return np.cos(2 * np.pi * points).sum(axis=1) - 0.5

    points, triangles = implicit_solid(tubes, 10)
    solid = as_manifold(points, triangles)
    assert solid.status().name == "NoError"
    fine = as_manifold(*implicit_solid(tubes, 20))
    assert solid.genus() == fine.genus()
    assert solid.volume() == pytest.approx(fine.volume(), rel=0.03)
    template = Template("tubes", Mesh(points, triangles))
    assert np.ptp(port_areas(template)) < 1e-9
