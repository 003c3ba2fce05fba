"""Each promise of a cell is broken by a cell made for it."""

import numpy as np
import pytest

from amprep.cells import cell_offer
from amprep.checks.cells.ports import PORTS
from amprep.checks.cells.printability import FEATURE, HOLE, POCKET, STEEP
from amprep.host import Host, Listed
from amprep.model import DeclaredCell, GraphCell, Mesh, MeshCell, Variant, When
from amprep.pipeline.check_cell import check_cell
from amprep.pipeline.resolve import ChosenCell, cell_named
from amprep.testing.problems import box_mesh

HOST = Host.load(plugins_enabled=False)


PIN = GraphCell([[0.5, 0.5, 0], [0.5, 0.5, 1]], [[0, 1]], 0.4)


def box(lo, hi):
    return box_mesh(np.array(lo, np.float64), np.array(hi, np.float64))


def both(one, other):
    triangles = np.vstack([one.triangles, other.triangles + len(one.vertices)])
    return Mesh(np.vstack([one.vertices, other.vertices]), triangles)


def hollow(lo, hi):
    inner = box(lo, hi)
    return both(box((0, 0, 0), (1, 1, 1)), Mesh(inner.vertices, inner.triangles[:, ::-1]))


def broken(cell, steps=12, **options):
    listed = Listed("cell", cell_offer("x", "A cell.", cell), "test")
    report = check_cell(ChosenCell.of(HOST, listed, {}), steps=steps, **options)
    return {violation.promise for violation in report.violations}


@pytest.mark.parametrize("name", ["prism", "x-wall", "strut", "bcc", "hatch"])
def test_built_in_cells_keep_every_promise(name):
    assert check_cell(cell_named(HOST, name)).violations == ()


def test_a_wall_without_gap_traps_powder_and_one_with_gap_does_not():
    """Thesis 3.5: walls that touch their neighbours all the way up leave powder no way out."""
    closed = check_cell(cell_named(HOST, "x-wall", ["join_every=1"]), steps=12)
    assert {violation.promise for violation in closed.violations} == {POCKET, HOLE}
    assert closed.measures.pocket > 0.3


def test_an_open_mesh_is_not_closed_and_a_large_one_not_in_the_cube():
    post = box((0.25, 0.25, 0), (0.75, 0.75, 1))
    assert broken(MeshCell(Mesh(post.vertices, post.triangles[1:]))) == {"closed"}
    assert broken(MeshCell(box((0.25, 0.25, 0), (0.75, 0.75, 1.5)))) == {"unit cube"}


@pytest.mark.parametrize(
    "cell",
    [
        MeshCell(box((0.25, 0.25, 0), (0.75, 0.75, 0.9))),  # does not reach the top
        MeshCell(both(box((0, 0.2, 0), (0.4, 0.4, 1)), box((0.6, 0.6, 0), (1, 0.8, 1)))),
        GraphCell([[0.2, 0.2, 0], [0.8, 0.8, 1]], [[0, 1]], 0.2),  # ends elsewhere than it begins
    ],
    ids=["too low", "sides differ", "strut ends elsewhere"],
)
def test_ports_that_do_not_match_are_found(cell):
    assert PORTS in broken(cell)


def test_a_variant_that_does_not_stand_on_the_other_is_found():
    foot = MeshCell(box((0.0, 0.0, 0), (0.2, 0.2, 1)))
    trunk = MeshCell(box((0.5, 0.5, 0), (0.9, 0.9, 1)))
    assert PORTS in broken(DeclaredCell((Variant(foot, When(roles={"foot"})), Variant(trunk))))


def test_struts_that_shear_makes_too_flat_are_found():
    """A strut at 45 degrees against the way of an oblique edge is at atan(1 / 2) on it."""
    points = [[0.5, 0.5, 0], [0.5, 0.5, 1], [0.0, 0.5, 0.5], [1.0, 0.5, 0.5]]
    cell = GraphCell(points, [[0, 1], [0, 2], [0, 3]], 0.2)
    assert broken(cell, angle_deg=40) == {STEEP}
    assert broken(cell, angle_deg=26) == set()


def test_wide_ceilings_are_found_and_narrow_ones_are_not():
    def table(width):
        post, top = box((0.4, 0.4, 0), (0.6, 0.6, 0.8)), box((0, 0.5 - width, 0.8), (1, 0.5 + width, 1))
        from manifold3d import Manifold, Mesh64

        solids = [Manifold(Mesh64(np.array(m.vertices), m.triangles.astype(np.uint64))) for m in (post, top)]
        mesh = (solids[0] + solids[1]).to_mesh64()
        return MeshCell(Mesh(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.int32)))

    assert STEEP in broken(table(0.3))
    assert STEEP not in broken(table(0.11))


def test_thin_walls_and_narrow_gaps_are_found():
    assert FEATURE in broken(MeshCell(box((0.48, 0, 0), (0.52, 1, 1))), feature=0.2)
    assert HOLE in broken(MeshCell(box((0.03, 0.0, 0), (0.97, 1.0, 1))), hole=0.4, steps=24)


def test_what_a_cell_promises_about_itself_counts():
    strict = DeclaredCell((Variant(PIN),), smallest_feature=1.5, least_angle_deg=50)
    assert broken(strict) == {STEEP, FEATURE}
