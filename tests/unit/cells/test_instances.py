"""Instances of cells expanded to closed meshes, against the union of each instance by manifold3d."""

import numpy as np
import pytest

from amprep.cells import instances as instances_module
from amprep.cells.instances import classify, expand_cells
from amprep.geometry.merging.union import union
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.topology import edges_match
from amprep.host import Host
from amprep.model import CellRequest, Grid, Stop, SupportEdges, silent


def emitted(cell, seed, count=30, **params):
    """A built-in cell on random edges with many junctions."""
    rng = np.random.default_rng(seed)
    rows = np.unique(rng.integers([1, 2, 2, 0], [4, 6, 6, 5], (count, 4)), axis=0)
    plane, y, x, direction = rows.T
    one = np.ones(len(rows))
    grid = Grid(np.zeros(3), 2.0, 2.0, (12, 9, 9))
    request = CellRequest(grid, SupportEdges(plane, y, x, direction, one, one, group=0 * one), 0 * one)
    host = Host.load(plugins_enabled=False)
    listed = host.choose("cell", cell)
    return classify(
        request, host.call(listed, request, params=host.params(listed, params), stop=Stop(), progress=silent)
    )


def each_by_itself(found):
    solids = []
    for template, matrix in zip(found.cells.template, found.cells.matrix, strict=True):
        points, triangles = found.templates[template]
        solids.append(as_manifold(points @ matrix[:, :3].T + matrix[:, 3], triangles))
    return union(solids)


@pytest.mark.parametrize("cell", ["prism", "x-wall", "strut", "bcc", "hatch"])
def test_built_in_cells_become_one_closed_mesh_of_the_union_s_volume(cell):
    found = emitted(cell, seed=len(cell))
    (mesh,) = expand_cells(found, np.ones(len(found.tiles), np.bool_))
    assert edges_match(mesh[1])
    assert as_manifold(*mesh).volume() == pytest.approx(each_by_itself(found).volume(), rel=1e-6)


def test_struts_have_the_genus_of_the_union_too():
    """Other built-in cells touch in edges, where manifold3d's answer depends on the order of the cells."""
    found = emitted("strut", seed=2, count=60)
    (mesh,) = expand_cells(found, np.ones(len(found.tiles), np.bool_))
    assert as_manifold(*mesh).genus() == each_by_itself(found).genus()


def test_seats_are_united_with_the_cells_they_lie_in():
    found = emitted("strut", seed=1)
    seats = np.array([[2, 3, 3], [2, 3, 4], [3, 4, 4]])
    (mesh,) = expand_cells(found, np.ones(len(found.tiles), np.bool_), seats, 0.2)
    plates = [(square[::-1] - (0, 0, 1)) * 2.0 + (1.0, 1.0, 1.9) for square in seats]
    from manifold3d import Manifold

    lids = [Manifold.cube((2.0, 2.0, 0.2), True).translate(place.tolist()) for place in plates]
    expected = union([each_by_itself(found), *lids])
    assert as_manifold(*mesh).volume() == pytest.approx(expected.volume(), rel=1e-6)


def test_cells_that_cannot_be_joined_on_arrays_come_one_mesh_a_direction(monkeypatch):
    found = emitted("strut", seed=3)
    every = np.ones(len(found.tiles), np.bool_)
    (mesh,) = expand_cells(found, every)
    monkeypatch.setattr(instances_module, "unite_cells", lambda *_: None)
    meshes = [as_manifold(*each) for each in expand_cells(found, every)]
    assert len(meshes) >= 5
    assert union(meshes).volume() == pytest.approx(as_manifold(*mesh).volume(), rel=1e-6)
