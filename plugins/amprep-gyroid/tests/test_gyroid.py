"""The gyroid keeps the promises of a cell and has the density or wall thickness asked for."""

import numpy as np
import pytest
from amprep_gyroid import GyroidParams, gyroid

from amprep.model import CellRequest, Grid, SupportEdges
from amprep.testing import check_cell, load_offer, try_plugin


def template(**params):
    """Return the template of one vertical edge in a grid of 4 mm."""
    one = np.ones(1)
    edges = SupportEdges(one, one, one, 0 * one, flow=one, capacity=one, group=0 * one)
    request = CellRequest(Grid(np.zeros(3), 4.0, 4.0, (3, 3, 3)), edges, role=0 * one)
    (only,) = load_offer("cell", "gyroid", plugin="amprep_gyroid", params=params).run(request).templates
    return only


def test_every_promise_holds_on_the_sample_problems():
    (report,) = try_plugin("amprep_gyroid")
    assert (report.name, report.violations) == ("gyroid", ())


@pytest.mark.parametrize("density", [0.2, 0.5, 0.7])
def test_a_network_fills_the_requested_fraction(density):
    assert template(density=density, resolution=20).mesh.signed_volume == pytest.approx(density, abs=0.02)


def test_a_wall_has_the_requested_thickness():
    # the gyroid's area in the unit cube is 3.0915 (numerically known): thin walls fill area times thickness
    walls = template(kind="wall", wall_mm=0.3, resolution=28).mesh
    assert walls.signed_volume == pytest.approx(3.0915 * 0.3 / 4.0, rel=0.05)


def test_walls_are_cut_finely_enough_to_have_no_holes():
    for wall in (0.4, 0.8):
        mesh = template(kind="wall", wall_mm=wall).mesh
        # Euler's formula for a closed surface of genus g: V - E + F = 2 - 2 g, with E = 3 F / 2
        genus = 1 - (len(mesh.vertices) - len(mesh.triangles) / 2) / 2
        assert genus == 2


def test_opposite_sides_are_cut_into_the_same_triangles():
    mesh = template().mesh
    for axis in range(3):
        low, high = (
            {
                tuple(sorted(map(tuple, np.delete(corners, axis, axis=1))))
                for corners in mesh.vertices[mesh.triangles]
                if (corners[:, axis] == end).all()
            }
            for end in (0.0, 1.0)
        )
        assert low
        assert low == high


def test_the_gradient_is_the_slope_of_the_function():
    points = np.random.default_rng(1).random((20, 3))
    value, gradient = gyroid(points)
    for axis in range(3):
        moved = gyroid(points + 1e-6 * np.eye(3)[axis])[0]
        assert (moved - value) / 1e-6 == pytest.approx(gradient[:, axis], abs=1e-3)


def test_it_can_be_printed_and_emptied():
    report = check_cell("gyroid", plugin="amprep_gyroid", pitch=4.0)
    assert (report.kinds, report.violations) == (("implicit",), ())
    assert report.measures.hole is not None
    assert report.measures.hole > 0.5


def test_bounds_are_named():
    for wrong in ({"density": 0.95}, {"wall_mm": 0}, {"resolution": 4}):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))} must be"):
            GyroidParams(**wrong)
