"""Connectors that would be too narrow are left out with the supports that carry nothing else."""

from dataclasses import replace
from functools import cache

import networkx as nx
import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.supported import part_of

from amprep.checks.supports.least_section import check_least_section
from amprep.geometry.connectors.least_width import LeastSection
from amprep.geometry.meshes.manifold import as_manifold
from amprep.host import Host
from amprep.model import Build, BuildSettings, BuildVolume, Grid, Stop, SupportEdges, silent
from amprep.model.contacts import ConnectorRules
from amprep.model.supports.rules import SupportRules
from amprep.supports.grid.red_squares import RedSquares
from amprep.supports.plan import plan_supports
from amprep.supports.rules import PlanningRules
from amprep.supports.solids.build import SolidRules, build_supports
from amprep.supports.solids.least_section import without_columns

SPACE = BuildVolume([60, 60, 60])
RULES = SupportRules(least_wall_mm=0.3, least_contact_mm2=0.09)


def box(size, corner):
    return Manifold.cube(size).translate(corner)


SHAPES = {
    "grazing table": box((8.13, 8.2, 2.0), (20.0, 20.0, 10.0)),
    "stairs": box((8.0, 4.1, 3.0), (20.0, 20.0, 9.0)) + box((8.0, 8.05, 2.0), (20.0, 20.0, 12.0)),
    "ridge": Manifold.hull_points([(20, 20, 14), (32, 20, 14), (20, 26, 14), (32, 26, 14), (20, 22.9, 10),
                                   (32, 22.9, 10), (20, 23.0, 10), (32, 23.0, 10)]),
    "ball": Manifold.sphere(6.0, 48).translate((26.0, 26.0, 14.0)),
    "tilted": box((12, 8, 2), (0, 0, 0)).rotate((0, 27.0, 13.0)).translate((22.0, 20.0, 12.0)),
}  # fmt: skip


@cache
def host():
    return Host.load(plugins_enabled=False)


@cache
def scene(shape, pitch=2.0):
    part = part_of(SHAPES[shape], shape)
    router = host().choose("router", "shortest-paths")

    def route(problem, stop, progress):
        params, rng = host().params(router, {}), np.random.default_rng(0)
        return host().call(router, problem, params=params, rng=rng, stop=stop, progress=progress)

    rules = PlanningRules(pitch_mm=pitch)
    return part, plan_supports((part,), SPACE, rules, route=route, stop=Stop(), progress=silent)


def supports(shape, pitch, least, connector="full", cell="x-wall"):
    part, layout = scene(shape, pitch)
    emitter = host().choose("cell", cell)
    params = host().params(emitter, {})
    return build_supports(
        layout,
        (part,),
        lambda request: host().call(emitter, request, params=params, stop=Stop(), progress=silent),
        SolidRules(connector=ConnectorRules(connector=connector), overlap=0.1, least=least),
        stop=Stop(),
        progress=silent,
    )


@pytest.mark.parametrize(("cell", "pitch"), [("prism", 1.0), ("prism", 2.0), ("x-wall", 2.0)])
@pytest.mark.parametrize("shape", SHAPES)
def test_no_section_is_thinner_than_the_least_wall(shape, cell, pitch):
    bodies = supports(shape, pitch, LeastSection(0.3, 0.09), cell=cell)
    build = Build(BuildSettings("b", SPACE, overlap=0.1, rules=RULES), (scene(shape, pitch)[0],), bodies)
    violations, sections = check_least_section(build, Stop())
    assert sections > 0
    assert violations == []


def widest(body, height):
    """Half the side of the largest square, to 0.01 mm, that fits into the section of a body."""
    section = as_manifold(body.mesh.vertices, body.mesh.triangles).slice(height)
    return max(half for half in np.arange(0.0, 2.0, 0.01) if not section.offset(-half).is_empty())


def test_a_ridge_is_held_by_posts_instead_of_a_sheet_of_its_own_width():
    """The ridge is 0.1 mm wide at its bottom, at a height of 10 mm."""
    (sheet,), (posts,) = supports("ridge", 2.0, None), supports("ridge", 2.0, LeastSection(0.3, 0.09))
    assert widest(sheet, 10.05) < 0.1
    assert widest(posts, 10.05) >= 0.15
    assert posts.mesh.bounds[1][2] == pytest.approx(10.1, abs=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_edges_that_lead_only_to_squares_without_a_connector_are_left_out(seed):
    """Every remaining edge leads up to a connected square, and every connected square down to the plate."""
    layout = scene("ball", 1.0)[1]
    rng = np.random.default_rng(seed)
    lost = layout.connected & (rng.random(len(layout.connected)) < 0.6)
    less = without_columns(layout, lost)
    up = nx.DiGraph(
        zip(map(tuple, less.edges.lower.tolist()), map(tuple, less.edges.upper.tolist()), strict=True)
    )
    ends = set(map(tuple, less.red.square[less.connected].tolist()))
    assert less.connected.sum() == layout.connected.sum() - lost.sum()
    assert all(node in ends for node in up if up.out_degree(node) == 0)
    assert all(any(down[0] == 0 for down in [*nx.ancestors(up, end), end]) for end in ends)
    assert set(less.red_group[less.connected].tolist()) <= set(layout.red_group[layout.connected].tolist())


def test_a_support_stays_below_a_strut_that_holds_another():
    """Two columns, a strut from the lower end at x = 3 up to x = 6: the column at x = 6 stays up to the strut."""
    grid = Grid(np.zeros(3), 1.0, 1.0, (20, 5, 12))
    columns = [[plane, 2, x, 0, 1, 1, 0] for x in (3, 6) for plane in range(1, 16)]
    strut = [[8 - k, 2, 6 - k, 2, 1, 1, 0] for k in range(3)]
    none = np.zeros(2, np.int32)
    red = RedSquares(np.array([(15, 2, 3), (15, 2, 6)], np.int32), none, none, none)
    edges = SupportEdges.from_rows(columns + strut)
    layout = replace(scene("ball")[1], grid=grid, edges=edges, red=red, connected=np.ones(2, np.bool_),
                     reasons=("", ""), red_group=none, feet=np.empty((0, 4), np.int32))  # fmt: skip
    less = without_columns(layout, np.array([False, True]))
    left = less.edges[less.edges.x == 6]
    assert sorted(left.plane.tolist()) == [1, 2, 3, 4, 5, 6, 7, 8, 8]
    bare = replace(layout, edges=SupportEdges.from_rows(columns))
    assert not (without_columns(bare, np.array([False, True])).edges.x == 6).any()
