"""The gyroid: the promises on sample problems, density and thickness as asked, cells that weld."""

import numpy as np
import pytest
from amprep_gyroid import GyroidParams, declare_gyroid, gyroid

from amprep.cells.emission import templates_of
from amprep.checks.cells.ports import port_areas
from amprep.geometry.meshes.manifold import as_manifold
from amprep.host import Host
from amprep.pipeline.check_cell import check_cell
from amprep.pipeline.resolve import cell_named
from amprep.testing.conformance import try_plugin


@pytest.fixture(scope="module")
def host():
    return Host.load(modules=["amprep_gyroid"], env={"AMPREP_LOAD_PLUGINS": ""})


def template(**params):
    (only,) = templates_of("gyroid", declare_gyroid(4.0, 4.0, GyroidParams(**params)), 4.0 * np.eye(3))
    return only


def test_every_promise_holds_on_the_sample_problems():
    (trial,) = try_plugin("amprep_gyroid")
    assert (trial.name, trial.violations) == ("gyroid", ())


@pytest.mark.parametrize("density", [0.2, 0.5, 0.7])
def test_a_network_fills_the_share_asked_for(density):
    assert template(density=density, resolution=20).mesh.signed_volume == pytest.approx(density, abs=0.02)


def test_a_wall_has_the_thickness_asked_for():
    # the gyroid's area in the unit cube is 3.0915 (numerically known): thin walls fill area times thickness
    walls = template(kind="wall", wall_mm=0.3, resolution=28).mesh
    assert walls.signed_volume == pytest.approx(3.0915 * 0.3 / 4.0, rel=0.05)


def test_walls_are_cut_finely_enough_to_have_no_holes():
    handles = {
        as_manifold(mesh.vertices, mesh.triangles).genus()
        for mesh in (template(kind="wall", wall_mm=wall).mesh for wall in (0.4, 0.8))
    }
    assert handles == {2}


def test_opposite_sides_are_cut_into_the_same_triangles():
    mesh = template().mesh
    areas = port_areas(template())
    assert areas[::2] == pytest.approx(areas[1::2])
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


def test_it_can_be_printed_and_emptied(host):
    report = check_cell(cell_named(host, "gyroid"), pitch=4.0)
    assert (report.kinds, report.violations) == (("implicit",), ())
    assert report.measures.hole > 0.5


def test_bounds_are_named():
    for wrong in ({"density": 0.95}, {"wall_mm": 0}, {"resolution": 4}):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))} is"):
            GyroidParams(**wrong)
