"""Legs of finished solids that are too long are divided; those without room for that are left out, the others stay."""

import numpy as np
from manifold3d import OpType
from tests.shared.layouts import Solid, box, layout, mesh_of, placed
from tests.shared.supported import build_of

from amprep.checks.supports.legs import check_legs
from amprep.measures.legs import legs_of
from amprep.model import Stop, SupportBody
from amprep.model.supports import SLENDER
from amprep.supports.legs.short_legs import without_long_legs

PARTS = placed(box((6, 3, 3), (0, 0, 20)))
"""A slab that needs columns 20 mm high."""


def builder(width_of):
    """Return a function that stands a post below each red square; `width_of` tells its width at a row of squares."""

    def build(planned):
        posts = [Solid.cube([9, 9, 1])]
        for edge in np.unique(planned.edges.upper[:, 1:], axis=0):
            y, x = edge.tolist()
            side = width_of(x)
            posts.append(box((side, side, 20.0), (x + 0.5 - side / 2, y + 0.5 - side / 2, 0)))
        solid = Solid.batch_boolean(posts, OpType.Add)
        return (SupportBody("supports of p0", mesh_of(solid), (0,)),)

    return build


def test_a_support_that_is_a_needle_is_left_out_and_its_overhang_has_a_reason():
    planned = layout(PARTS, leg_ratio=0.0, territory="shared", oblique_cost=100)
    assert planned.connected.all()
    is_needle = planned.red.square[:, 2] == planned.red.square[:, 2].max()
    needle = int(planned.red.square[:, 2].max())
    # The post beside the needle is one with its wide neighbour; struts end in posts of their own, which help nothing.
    widths = {needle - 1: 0.5}
    built = without_long_legs(
        builder(lambda x: 0.4 if x >= needle else widths.get(x, 2.2)), planned, PARTS, 10.0
    )
    assert (~built.layout.connected).tolist() == is_needle.tolist()
    assert {built.layout.reasons[i] for i in np.flatnonzero(is_needle)} == {SLENDER}
    assert needle not in built.layout.edges.upper[:, 2]
    assert set(built.layout.edges.upper[:, 2].tolist()) == set(range(needle))
    build = build_of([box((6, 3, 3), (0, 0, 20))], [], leg_ratio=10.0)
    assert check_legs(type(build)(build.settings, build.parts, built.bodies), Stop()) == []


def stand_of(given):
    """Return the edges of a layout as struts 0.9 mm wide."""
    struts, (left, front, _) = [], given.grid.origin
    for upper, lower in zip(given.edges.upper.tolist(), given.edges.lower.tolist(), strict=True):
        ends = [box((0.9, 0.9, 0.01), (left + x + 0.05, front + y + 0.05, z)) for z, y, x in (upper, lower)]
        struts.append(Solid.batch_hull(ends))
    return (SupportBody("supports", mesh_of(Solid.batch_boolean(struts, OpType.Add)), (0,)),)


def test_a_leg_that_only_the_solid_shows_is_divided_where_there_is_room():
    parts = placed(box((1, 1, 3), (20, 20, 14)))
    planned = layout(parts, leg_ratio=0.0, oblique_cost=100)
    assert legs_of(stand_of(planned)[0].mesh, 1.0, 12.0).too_long
    built = without_long_legs(stand_of, planned, parts, 10.0)
    assert built.layout.connected.all()
    assert len(built.layout.edges) > len(planned.edges)
    assert not legs_of(built.bodies[0].mesh, 1.0, 10.0).too_long
    again = without_long_legs(stand_of, planned, parts, 10.0)
    np.testing.assert_array_equal(again.layout.edges.upper, built.layout.edges.upper)


def test_without_a_limit_and_without_long_legs_nothing_is_built_twice():
    planned = layout(PARTS, leg_ratio=0.0, territory="shared", oblique_cost=100)
    calls = []

    def build(given):
        calls.append(given)
        return builder(lambda _: 0.4)(given)

    assert without_long_legs(build, planned, PARTS, 0.0).layout is planned
    assert len(calls) == 1


def test_a_stop_ends_the_rounds():
    planned = layout(PARTS, leg_ratio=0.0, territory="shared", oblique_cost=100)
    built = without_long_legs(builder(lambda _: 0.4), planned, PARTS, 10.0, Stop.after(0.0))
    assert built.layout is planned
    assert len(built.bodies) == 1
