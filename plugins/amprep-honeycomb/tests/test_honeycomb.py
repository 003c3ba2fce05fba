"""The cells in files keep their promises, can be used by name and by path, and grow with the load."""

from pathlib import Path

import amprep_honeycomb
import numpy as np
import pytest

import amprep
from amprep.model import CellRequest, Grid, SupportEdges
from amprep.testing import check_cell, load_offer, try_offer

FOLDER = Path(amprep_honeycomb.__file__).parent
NAMES = ["honeycomb", "honeycomb-frame"]


def load(name):
    return load_offer("cell", name, plugin="amprep_honeycomb")


def test_each_file_is_one_offer_with_its_own_kind():
    assert {name: load(name).kinds for name in NAMES} == {
        "honeycomb": ("mesh",),
        "honeycomb-frame": ("graph",),
    }


@pytest.mark.parametrize("name", NAMES)
def test_every_promise_holds_on_the_sample_problems(name):
    assert try_offer(load(name)).violations == ()


@pytest.mark.parametrize("name", NAMES)
def test_it_can_be_printed_and_emptied(name):
    assert check_cell(name, plugin="amprep_honeycomb").violations == ()


@pytest.mark.parametrize("file", ["honeycomb.stl", "honeycomb.toml", "honeycomb-frame.toml"])
def test_the_files_are_cells_without_the_package(file):
    cell = load_offer("cell", FOLDER / file)
    assert cell.name == file.partition(".")[0]
    assert all(0.0 < volume < 8.0 for volume in cell.material(2.0, 2.0))


def test_the_honeycomb_has_the_area_of_its_walls_in_plan():
    # above the windows: half a unit of walls along y, four slanted ones, less a little for the corners where three meet
    mesh = amprep.load(FOLDER / "honeycomb.stl").parts[0].mesh
    corners = mesh.vertices[mesh.triangles]
    top = corners[(corners[:, :, 2] == 1.0).all(axis=1)]
    sides = top[:, 1:, :2] - top[:, :1, :2]
    area = float(np.linalg.det(sides).sum() / 2)
    length = 2 * 0.34 + 4 * np.hypot(0.5, 0.16)
    assert area == pytest.approx(0.12 * length, rel=0.1)


def test_pins_grow_with_the_load():
    frame = Grid(np.zeros(3), 2.0, 2.0, (4, 9, 9))
    zero, load = np.zeros(3, np.int32), [1, 6, 40]
    request = CellRequest(
        frame, SupportEdges(zero + 1, zero + 1, [1, 3, 5], zero, load, load, group=zero), zero
    )
    cells = load_offer("cell", FOLDER / "honeycomb-frame.toml").run(request)
    by_edge = dict(zip(cells.edge.tolist(), cells.template.tolist(), strict=True))
    volumes = [cells.templates[by_edge[edge]].mesh.signed_volume for edge in range(3)]
    assert volumes[2] / volumes[0] == pytest.approx(1.3**2, rel=1e-6)
    assert volumes[0] < volumes[1] < volumes[2]
