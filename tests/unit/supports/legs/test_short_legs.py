"""Supports whose finished solids have legs that are too long are left out, and the others stay."""

import numpy as np
from manifold3d import OpType
from tests.shared.layouts import Solid, box, layout, mesh_of, placed
from tests.shared.supported import build_of

from amprep.checks.supports.legs import check_legs
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
    widths = {needle: 0.4, needle - 1: 0.5}  # the post beside the needle is one with its wide neighbour
    built = without_long_legs(builder(lambda x: widths.get(x, 2.2)), planned, PARTS, 10.0)
    assert (~built.layout.connected).tolist() == is_needle.tolist()
    assert {built.layout.reasons[i] for i in np.flatnonzero(is_needle)} == {SLENDER}
    assert needle not in built.layout.edges.upper[:, 2]
    assert set(built.layout.edges.upper[:, 2].tolist()) == set(range(needle))
    build = build_of([box((6, 3, 3), (0, 0, 20))], [], leg_ratio=10.0)
    assert check_legs(type(build)(build.settings, build.parts, built.bodies), Stop()) == []


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
