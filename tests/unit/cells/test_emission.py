"""Declared cells: the variant of each edge, the growth of struts with the load, and beams."""

from dataclasses import replace

import numpy as np
import pytest
from tests.shared.cells import PIN, POST, emitted, request
from tests.shared.optional import present

from amprep.cells import cell_offer
from amprep.cells.emission import edges_for, emit_declared, sides_taken
from amprep.cells.samples import block, single_column
from amprep.checks.cells.templates import check_cells
from amprep.model import (
    DeclaredCell,
    GraphCell,
    Role,
    Variant,
    When,
)


def test_the_first_variant_that_fits_replaces_an_edge():
    cell = DeclaredCell(
        (Variant(POST, When(roles={"foot"})), Variant(PIN, When(edges="oblique")), Variant(POST))
    )
    asked = request([1, 2, 3], direction=[1, 1, 0], role=[Role.FOOT, Role.TRUNK, Role.TRUNK])
    cells = emit_declared(cell, asked)
    names = {
        edge: cells.templates[kind].name
        for edge, kind in zip(cells.edge.tolist(), cells.template.tolist(), strict=True)
    }
    assert names == {0: "mesh 0", 1: "graph 1", 2: "mesh 2"}
    assert check_cells(asked, cells) == []


def test_edges_without_a_variant_stay_empty():
    cells = emit_declared(DeclaredCell((Variant(PIN, When(least_load=5)),)), request([1, 2], load=[4, 5]))
    assert cells.edge.tolist() == [1]


def test_layers_are_counted_from_the_plate():
    assert edges_for(When(every=3, layer=0), request([1, 2, 3, 4])).tolist() == [True, False, False, True]


def test_the_surface_of_a_block_is_where_neighbours_are_missing():
    asked = block(2.0, 2.0, width=3, layers=2)
    surface = edges_for(When(roles={"surface"}), asked)
    trunk = asked.role == Role.TRUNK
    assert (surface.sum(), trunk.sum()) == (8, 9)
    assert sides_taken(asked)[trunk & ~surface].all()


def test_cross_sections_grow_with_the_load_up_to_full_load():
    cell = DeclaredCell.of(GraphCell(PIN.points, PIN.struts, 0.2, growth=2.0, full_load=9))
    asked = request([2] * 4, load=[1, 5, 9, 90])
    cells = emit_declared(cell, asked)
    volume = dict.fromkeys(range(4), 0.0)
    for edge, kind in zip(cells.edge.tolist(), cells.template.tolist(), strict=True):
        volume[edge] = cells.templates[kind].mesh.signed_volume * 8 / (np.pi * 0.04 * 2)
    assert list(volume.values()) == pytest.approx([1.0, 2.5, 4.0, 4.0])


def test_struts_become_beams_that_join_in_common_points():
    column = single_column(2.0, 2.0, 1)
    cells = emit_declared(DeclaredCell.of(PIN), column, solid=False)
    assert len(cells.template) == 0
    beams = present(cells.beams)
    assert (len(beams.struts), len(beams.nodes)) == (len(column.edges), len(column.edges) + 1)
    assert set(beams.radii.ravel().tolist()) == {0.4}
    lengths = np.linalg.norm(np.diff(beams.nodes[beams.struts], axis=1)[:, 0], axis=1)
    assert lengths == pytest.approx(2 * np.sqrt(2))


def test_the_request_may_ask_for_beams_or_for_none():
    offer = cell_offer("pin", "A pin.", PIN)
    plain = request([1])
    assert emitted(offer, replace(plain, beams=True)).beams is not None
    without = emitted(offer, replace(plain, beams=False), solid=False)
    assert without.beams is None
    assert len(without.template) == len(plain.edges)


def test_walls_without_thickness_become_sheets_where_they_may():
    square = [[0.5, 0, 0], [0.5, 1, 0], [0.5, 1, 1], [0.5, 0, 1]]
    cell = DeclaredCell.of(GraphCell(square, faces=[[0, 1, 2], [0, 2, 3]]))
    (sheet,) = emit_declared(cell, request([1])).templates
    assert (sheet.surface, len(sheet.mesh.triangles)) == (True, 2)
