"""Declared cells: which variant an edge gets, how thick its struts are, beams, and the built-in lattices."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from amprep.cells import cell_offer
from amprep.cells.answers import checked
from amprep.cells.emission import edges_for, emit_declared, sides_taken
from amprep.cells.samples import block, single_column
from amprep.checks.cells.ports import check_ports
from amprep.checks.cells.templates import check_cells
from amprep.errors import JobError, PluginError
from amprep.host import Host, Listed
from amprep.model import (
    CellRequest,
    DeclaredCell,
    GraphCell,
    Grid,
    ImplicitCell,
    MeshCell,
    Role,
    Stop,
    SupportEdges,
    Variant,
    When,
    silent,
)
from amprep.testing.problems import box_mesh

PIN = GraphCell([[0.5, 0.5, 0], [0.5, 0.5, 1]], [[0, 1]], 0.4)
POST = MeshCell(box_mesh(np.array([0.25, 0.25, 0.0]), np.array([0.75, 0.75, 1.0])))
FRAME = Grid(np.zeros(3), 2.0, 2.0, (9, 9, 9))


def request(plane, direction=0, role=Role.TRUNK, load=1):
    count = len(plane)
    columns = (plane, 1, 2 * np.arange(count), direction, load, load, 0, 0)
    edges = SupportEdges(*(np.broadcast_to(each, count) for each in columns))
    return CellRequest(FRAME, edges, np.broadcast_to(role, count))


def emitted(offer, asked, **table):
    host = Host.load(plugins_enabled=False)
    listed = Listed("cell", offer, "test")
    return host.call(listed, asked, params=host.params(listed, table), stop=Stop(), progress=silent)


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
    beams = cells.beams
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


def test_beams_are_refused_where_none_are_wanted():
    made = emitted(cell_offer("pin", "A pin.", PIN), request([1]), solid=False)
    assert checked(request([1]), made) is made
    with pytest.raises(PluginError, match=r"beams where request\.beams is False"):
        checked(replace(request([1]), beams=False), made)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"struts": np.array([[0, 9]])}, "strut index"),
        ({"radii": np.array([[0.4, 0.0]])}, "not above 0"),
        ({"radii": np.array([[0.4]])}, "do not match"),
        ({"group": np.array([3])}, "group index"),
        ({"nodes": np.full((2, 3), np.nan)}, "not finite"),
    ],
)
def test_unsound_beams_of_a_plugin_are_refused(change, why):
    made = emitted(cell_offer("pin", "A pin.", PIN), request([1]), solid=False)
    with pytest.raises(PluginError, match=why):
        checked(request([1]), replace(made, beams=replace(made.beams, **change)))


def test_walls_without_thickness_become_sheets_where_they_may():
    square = [[0.5, 0, 0], [0.5, 1, 0], [0.5, 1, 1], [0.5, 0, 1]]
    cell = DeclaredCell.of(GraphCell(square, faces=[[0, 1, 2], [0, 2, 3]]))
    (sheet,) = emit_declared(cell, request([1])).templates
    assert (sheet.surface, len(sheet.mesh.triangles)) == (True, 2)


def test_a_graph_without_params_of_its_own_can_be_made_thicker():
    offer = cell_offer("pin", "A pin.", PIN)
    thin, thick = (emitted(offer, request([1]), radius_factor=factor).templates[0] for factor in (1.0, 1.5))
    assert thick.mesh.signed_volume / thin.mesh.signed_volume == pytest.approx(2.25)
    with pytest.raises(JobError, match="radius_factor must be between"):
        emitted(offer, request([1]), radius_factor=99)


@dataclass(frozen=True)
class BallParams:
    radius: float = 0.55


def test_a_function_of_params_declares_a_cell_for_the_grid_at_hand():
    def declare(pitch, step, params):
        return ImplicitCell(
            lambda points: params.radius - np.linalg.norm(np.mod(points, 1.0) - 0.5, axis=1), 12
        )

    offer = cell_offer("ball", "Balls that touch.", declare, params=BallParams)
    asked = block(2.0, 2.0, width=2, layers=2)
    cells = emitted(offer, asked)
    assert (check_cells(asked, cells), check_ports(asked, cells)) == ([], [])
    assert offer.declare(2.0, 2.0, BallParams()).kinds == ("implicit",)


def test_a_declaration_that_is_none_or_empty_is_refused():
    with pytest.raises(PluginError, match="expected a shape or a DeclaredCell, got str"):
        emitted(cell_offer("x", "Nothing.", lambda pitch, step, params: "bcc"), request([1]))
    with pytest.raises(JobError, match="nowhere positive"):
        emitted(
            cell_offer("x", "Empty.", ImplicitCell(lambda points: -np.ones(len(points)), 8)), request([1])
        )


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"struts": [[0, 2]]}, "struts must refer to points 0 to 1"),
        ({"struts": [[0, 0]]}, "a strut must join two different points"),
        ({"points": [[0, 0, 0], [0, 0, 1.1]]}, "points must be inside the unit cube"),
        ({"radius": 0.0}, "radii must be above 0"),
        ({"struts": np.empty((0, 2))}, "a graph must have struts or faces"),
        ({"growth": 0.5}, "growth must be between 1 and 10"),
        ({"full_load": 1}, "full_load must be at least 2"),
    ],
)
def test_a_graph_without_sense_is_refused(wrong, reason):
    with pytest.raises(ValueError, match=reason):
        GraphCell(**{"points": PIN.points, "struts": PIN.struts, **wrong})


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"roles": {"roof"}}, "roles must be among trunk, surface, foot, connector"),
        ({"edges": "up"}, "edges must be one of any, straight, oblique"),
        ({"least_load": 3, "most_load": 2}, "least_load must be at most most_load"),
        ({"every": 0}, "every must be at least 1"),
        ({"every": 2, "layer": 2}, "layer must be at least 0 and below every"),
    ],
)
def test_a_condition_without_sense_is_refused(wrong, reason):
    with pytest.raises(ValueError, match=reason):
        When(**wrong)


BUILT_IN = Host.load(plugins_enabled=False)


@pytest.mark.parametrize("name", ["strut", "bcc", "hatch"])
@pytest.mark.parametrize("direction", range(5))
def test_built_in_lattices_keep_the_promises_of_templates_and_match_their_neighbours(name, direction):
    asked = block(2.0, 2.0, direction=direction, layers=4)
    listed = BUILT_IN.choose("cell", name)
    cells = BUILT_IN.call(listed, asked, params=listed.offer.params(), stop=Stop(), progress=silent)
    assert check_cells(asked, cells) == []
    assert check_ports(asked, cells) == []


@pytest.mark.parametrize("name", ["strut", "bcc", "hatch"])
def test_the_estimate_is_what_a_column_takes(name):
    listed = BUILT_IN.choose("cell", name)
    params = BUILT_IN.params(listed, {"tooth_pitch_mm": 0, "fragment_every": 0} if name == "hatch" else {})
    expected = BUILT_IN.material(listed, 2.0, 2.0, params)
    for direction, volume in enumerate(expected):
        asked = single_column(2.0, 2.0, direction)
        cells = BUILT_IN.call(listed, asked, params=params, stop=Stop(), progress=silent)
        volumes = np.array([template.mesh.signed_volume for template in cells.templates])
        assert volumes[cells.template].mean() * 8 == pytest.approx(volume)


def test_hatch_has_walls_windows_teeth_and_gaps():
    def volume(**table):
        listed = BUILT_IN.choose("cell", "hatch")
        params = BUILT_IN.params(
            listed, {"perforation_mm": 0, "tooth_pitch_mm": 0, "fragment_every": 0, **table}
        )
        asked = request([1], role=Role.FOOT)
        cells = BUILT_IN.call(listed, asked, params=params, stop=Stop(), progress=silent)
        return cells.templates[0].mesh.signed_volume * 8

    # two walls of 0.25 mm in each direction, 2 mm high and long, less their four crossings
    plain = 2 * (4 * 2 * 0.25 - 4 * 0.25**2)
    assert volume() == pytest.approx(plain)
    # diamonds of 0.5 x 0.714 mm in the spans: one whole and two halves in each of four walls
    assert plain - volume(perforation_mm=0.5) == pytest.approx(
        4 * 2 * 0.25 * 0.5 * 0.5 * np.tan(np.radians(55)) / 2, rel=1e-4
    )
    # wedges 0.8 mm deep between teeth of 0.5 mm a millimetre: less where the other walls' teeth fill them
    assert plain - volume(tooth_pitch_mm=1.0) == pytest.approx(8 * 0.25 * 0.5 * 0.5 * 0.8 / 1, rel=0.15)
    # the request's edge is at x = 0, y = 1: two walls lose 0.2 mm, where no other wall is
    assert plain - volume(fragment_every=6) == pytest.approx(2 * 0.2 * 0.25 * 2)


@pytest.mark.parametrize(
    ("name", "table", "reason"),
    [
        ("strut", {"diameter_mm": 1.5}, "strut: struts of 1.5 mm need a pitch of at least 3 mm"),
        ("bcc", {"diameter_mm": 0}, "diameter_mm must be above 0"),
        ("strut", {"tie_every": -1}, "tie_every must be at least 0"),
        ("hatch", {"wall_mm": 1.2}, "hatch: walls of 1.2 mm every 1 mm leave no room"),
        ("hatch", {"fragment_gap_mm": 0.6}, "fragment_gap_mm = 0.6 does not fit"),
        ("hatch", {"tooth_pitch_mm": 0.3}, "tooth_width_mm must be at most tooth_pitch_mm"),
        ("hatch", {"perforation_mm": -1}, "perforation_mm must be at least 0"),
    ],
)
def test_what_does_not_fit_the_grid_is_said_in_numbers(name, table, reason):
    listed = BUILT_IN.choose("cell", name)
    with pytest.raises(JobError, match=reason):
        BUILT_IN.call(
            listed, request([1, 2]), params=BUILT_IN.params(listed, table), stop=Stop(), progress=silent
        )
