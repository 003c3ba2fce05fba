"""Cells given as files: found, judged, used by name and by path, thicker with the load."""

from pathlib import Path

import amprep_honeycomb
import numpy as np
import pytest

from amprep.cells import read_cell
from amprep.cells.emission import emit_declared
from amprep.host import Host
from amprep.model import CellRequest, Grid, SupportEdges
from amprep.pipeline.check_cell import check_cell
from amprep.pipeline.resolve import cell_named
from amprep.testing.conformance import try_offer

FOLDER = Path(amprep_honeycomb.__file__).parent
NAMES = ["honeycomb", "honeycomb-frame"]


@pytest.fixture(scope="module")
def host():
    return Host.load(modules=["amprep_honeycomb"], env={"AMPREP_LOAD_PLUGINS": ""})


def test_each_file_is_one_offer_with_its_own_kind(host):
    offers = {name: host.choose("cell", name) for name in NAMES}
    kinds = {name: host.declared(each, 2.0, 2.0, each.offer.params()).kinds for name, each in offers.items()}
    assert kinds == {"honeycomb": ("mesh",), "honeycomb-frame": ("graph",)}


@pytest.mark.parametrize("name", NAMES)
def test_every_promise_holds_on_the_sample_problems(host, name):
    assert try_offer(host, host.choose("cell", name)).violations == ()


@pytest.mark.parametrize("name", NAMES)
def test_it_can_be_printed_and_emptied(host, name):
    assert check_cell(cell_named(host, name)).violations == ()


@pytest.mark.parametrize("file", ["honeycomb.stl", "honeycomb.toml", "honeycomb-frame.toml"])
def test_the_files_are_cells_without_the_package(file):
    bare = Host.load(plugins_enabled=False)
    cell = cell_named(bare, str(FOLDER / file))
    assert cell.name == file.partition(".")[0]
    assert all(0.0 < volume < 8.0 for volume in cell.material(2.0, 2.0))


def test_the_honeycomb_has_the_area_of_its_walls_in_plan():
    # above the windows: half a unit of walls along y, four slanted ones, less a little for the corners where three meet
    cell = read_cell(FOLDER / "honeycomb.toml", mesh_of).cell
    mesh = cell.variants[0].shape.mesh
    corners = mesh.vertices[mesh.triangles]
    top = corners[(corners[:, :, 2] == 1.0).all(axis=1)]
    sides = top[:, 1:, :2] - top[:, :1, :2]
    area = float(np.linalg.det(sides).sum() / 2)
    length = 2 * 0.34 + 4 * np.hypot(0.5, 0.16)
    assert area == pytest.approx(0.12 * length, rel=0.1)


def mesh_of(path):
    host = Host.load(plugins_enabled=False)
    (part,) = host.call(host.reader_for(path), path, params=host.params(host.reader_for(path), {}))
    return part.mesh


def test_pins_grow_with_the_load():
    cell = read_cell(FOLDER / "honeycomb-frame.toml", mesh_of).cell
    frame = Grid(np.zeros(3), 2.0, 2.0, (4, 9, 9))
    zero, load = np.zeros(3, np.int32), [1, 6, 40]
    request = CellRequest(
        frame, SupportEdges(zero + 1, zero + 1, [1, 3, 5], zero, load, load, group=zero), zero
    )
    cells = emit_declared(cell, request)
    by_edge = dict(zip(cells.edge.tolist(), cells.template.tolist(), strict=True))
    volumes = [cells.templates[by_edge[edge]].mesh.signed_volume for edge in range(3)]
    assert volumes[2] / volumes[0] == pytest.approx(1.3**2, rel=1e-6)
    assert volumes[0] < volumes[1] < volumes[2]
