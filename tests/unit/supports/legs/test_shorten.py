"""Long legs are braced, get a column beside them, or become thicker: judged on solids by slices of manifold3d."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from manifold3d import Manifold, OpType
from tests.shared.examples import examples
from tests.shared.legs import sliced_legs

from amprep.model import Grid, SupportEdges, Voxel
from amprep.model.supports.edges import DIRECTIONS
from amprep.supports.legs.cell import square_cell
from amprep.supports.legs.find import find_legs
from amprep.supports.legs.leave_out import keep_legs_short, words_of
from amprep.supports.legs.room import OpenVoxels
from amprep.supports.legs.sections import find_sections
from amprep.supports.legs.shorten import LegRules, shorten_legs

RULES = LegRules(10.0, square_cell(1.0))


def column(y, x, top, part=0, bottom=0):
    return [[plane, y, x, 0, 1, 1, part] for plane in range(bottom + 1, top + 1)]


def empty_grid(*closed, shape=(60, 15, 30)):
    voxels = np.full(shape, Voxel.FREE, np.uint8)
    for block in closed:
        voxels[block] = Voxel.CLOSED
    return Grid(np.zeros(3), 1.0, 1.0, shape), voxels


def shorten(grid, voxels, edges, held, rules=RULES, opened=None):
    return shorten_legs(
        grid, edges, np.array(held, np.int32), rules, opened or (lambda _: OpenVoxels(voxels))
    )


def prisms(edges):
    """The union of the sheared prisms of edges on a grid of 1 mm."""
    solids = []
    for (plane, y, x), direction in zip(edges.upper.tolist(), edges.direction.tolist(), strict=True):
        dy, dx = DIRECTIONS[direction]
        square = [(0, 0), (1, 0), (1, 1), (0, 1)]
        corners = [(x + a, y + b, plane) for a, b in square]
        corners += [(x + dx + a, y + dy + b, plane - 1) for a, b in square]
        solids.append(Manifold.hull_points(np.array(corners, float)))
    return Manifold.batch_boolean(solids, OpType.Add)


def worst_ratio(edges, held):
    """The largest ratio of a leg in two slices of each layer of the grid."""
    tops = [((x, y, plane - 0.75), (x + 1, y + 1, plane)) for plane, y, x in held]
    heights = np.arange(0.25, int(edges.plane.max()), 0.5)
    return max(sliced_legs(prisms(edges), heights, contacts=tops), default=0.0)


def together(edges, legs):
    return SupportEdges.concatenate([edges, legs.edges]).merged()


def test_two_columns_brace_each_other_by_few_struts():
    edges = SupportEdges.from_rows(column(7, 3, 30) + column(7, 8, 30))
    grid, voxels = empty_grid()
    held = [(30, 7, 3), (30, 7, 8)]
    assert worst_ratio(edges, held) > 25
    legs = shorten(grid, voxels, edges, held)
    assert (legs.divided > 0, legs.thickened, legs.left) == (True, 0, ())
    assert worst_ratio(together(edges, legs), held) <= 10
    assert len(legs.edges) <= 0.6 * len(edges)


def test_a_lone_leg_gets_a_column_beside_it_that_stands_on_the_plate():
    edges = SupportEdges.from_rows(column(7, 7, 17))
    grid, voxels = empty_grid()
    legs = shorten(grid, voxels, edges, [(17, 7, 7)])
    assert legs.left == ()
    assert legs.edges.plane.min() == 1
    assert worst_ratio(together(edges, legs), [(17, 7, 7)]) <= 10
    assert len(legs.edges) <= 12


def test_a_lone_leg_in_a_narrow_well_becomes_thicker_towards_the_plate():
    well = np.ones((15, 30), np.bool_)
    well[7:9, 7:9] = False
    grid, voxels = empty_grid((slice(None), *np.nonzero(well)))
    edges = SupportEdges.from_rows(column(7, 7, 19))
    legs = shorten(grid, voxels, edges, [(19, 7, 7)])
    assert legs.thickened == 1
    assert legs.left == ()
    whole = together(edges, legs)
    squares = [len(np.unique(whole.lower[whole.lower[:, 0] == plane], axis=0)) for plane in (0, 8, 12)]
    assert squares == [3, 3, 1], "an L of three squares is two squares wide"
    assert worst_ratio(whole, [(19, 7, 7)]) <= 10


def test_what_cannot_be_mended_is_left_with_its_place_and_said_in_words():
    grid, voxels = empty_grid((slice(None), [6, 8, 7, 7], [7, 7, 6, 8]))
    edges = SupportEdges.from_rows(column(7, 7, 24))
    legs = shorten(grid, voxels, edges, [(24, 7, 7)])
    assert len(legs.edges) == 0
    (left,) = legs.left
    assert left.ratio == pytest.approx(24.0, abs=1.5)
    assert left.position_mm == pytest.approx((7.5, 7.5, 12.0), abs=1)


def kept_short(grid, voxels, edges, red, feet=()):
    return keep_legs_short(
        grid,
        edges,
        (np.array(red, np.int32), np.array(feet, np.int32).reshape(-1, 3)),
        RULES,
        lambda _: OpenVoxels(voxels),
    )


def test_what_cannot_be_mended_is_left_out_with_what_only_it_carries_and_said_in_words():
    grid, voxels = empty_grid((slice(None), [6, 8, 7, 7], [7, 7, 6, 8]))
    short = column(7, 20, 9)
    edges = SupportEdges.from_rows(column(7, 7, 24) + short)
    legs = kept_short(grid, voxels, edges, [(24, 7, 7), (9, 7, 20)])
    assert legs.lost.tolist() == [True, False]
    assert legs.edges.rows() == SupportEdges.from_rows(short).merged().rows()
    (words,) = words_of(legs, 10.0)
    assert "1 leg left out that would be longer than 10 widths" in words
    assert "24.0 widths long, at 8, 8, 12 mm" in words


@pytest.mark.parametrize(("top", "stays"), [(10, True), (11, False)])
def test_a_leg_up_to_the_ratio_stays_where_it_cannot_be_braced(top, stays):
    grid, voxels = empty_grid((slice(None), [6, 8, 7, 7], [7, 7, 6, 8]))
    legs = kept_short(grid, voxels, SupportEdges.from_rows(column(7, 7, top)), [(top, 7, 7)])
    assert legs.lost.tolist() == [not stays]
    assert len(legs.edges) == top * stays


def test_a_column_that_a_strut_carries_stays_above_a_leg_that_is_left_out():
    shut = (slice(0, 20), slice(None), [6, 7, 8])
    grid, voxels = empty_grid(shut)
    rows = column(7, 12, 32) + column(7, 13, 32) + column(8, 12, 32) + column(8, 13, 32)
    strut = [[26 - k, 7, 7 + k, 3, 1, 1, 0] for k in range(5)]
    edges = SupportEdges.from_rows(column(7, 7, 32) + rows + strut)
    red = [(32, 7, 7), (32, 7, 12)]
    legs = kept_short(grid, voxels, edges, red)
    assert not legs.lost.any()
    assert legs.left_out
    assert worst_ratio(legs.edges, red) <= 10
    assert (legs.edges.plane[(legs.edges.x == 7)] > 20).all(), "nothing hangs below the strut"


def test_short_legs_and_walls_beside_each_other_stay_as_they_are():
    grid, voxels = empty_grid()
    short = SupportEdges.from_rows(column(7, 3, 9) + column(7, 20, 9))
    assert len(shorten(grid, voxels, short, [(9, 7, 3), (9, 7, 20)]).edges) == 0
    rows = [row for y in range(3, 7) for x in range(3, 7) for row in column(y, x, 36)]
    block = SupportEdges.from_rows(rows)
    assert len(shorten(grid, voxels, block, [(36, 3, 3)]).edges) == 0
    assert words_of(kept_short(grid, voxels, block, [(36, 3, 3)]), 10.0) == ()


def bent_wall(low, high, top):
    """Two columns beside each other that step aside at two planes."""
    rows = []
    for x, at in ((3, low), (4, high)):
        rows += column(8, x, top, bottom=at) + [[at, 8, x, 4, 1, 1, 0]] + column(7, x, at - 1)
    return SupportEdges.from_rows(rows)


@pytest.mark.parametrize(("low", "high"), [(7, 7), (7, 8), (7, 9)])
def test_two_columns_with_a_bend_are_one_leg_that_is_no_wider_there(low, high):
    grid, _ = empty_grid()
    edges = bent_wall(low, high, 20)
    sections = find_sections(grid, edges, np.array([(20, 8, 3), (20, 8, 4)], np.int32), RULES.cell)
    (leg,) = find_legs(sections)
    assert len(leg.lengths) == 20
    assert leg.ratio() == pytest.approx(20.4, abs=0.5)


def test_no_strut_leads_to_a_column_that_touches_along_an_edge():
    edges = SupportEdges.from_rows(column(7, 7, 18) + column(8, 8, 18))
    grid, voxels = empty_grid()
    held = [(18, 7, 7), (18, 8, 8)]
    legs = shorten(grid, voxels, edges, held)
    assert legs.left == ()
    used = {(y, x) for _, y, x in legs.edges.voxels.tolist()}
    assert used - {(7, 7), (8, 8), (7, 8), (8, 7)}, "further columns, not struts between both"


def test_struts_keep_to_the_open_voxels_of_their_part_and_out_of_other_supports():
    edges = SupportEdges.from_rows(column(7, 3, 30) + column(7, 8, 30) + column(7, 5, 40, part=1))
    grid, voxels = empty_grid()
    opened = np.zeros((60, 3, 12), np.bool_)
    opened[:, :, :8] = True

    def territory(part):
        return OpenVoxels(voxels, (6, 2), opened) if part == 0 else OpenVoxels(voxels)

    legs = shorten(grid, voxels, edges, [(30, 7, 3), (30, 7, 8), (40, 7, 5)], opened=territory)
    own = legs.edges.part == 0
    used = legs.edges[own].voxels
    assert own.any()
    assert ((used[:, 1] >= 6) & (used[:, 1] < 9) & (used[:, 2] >= 2) & (used[:, 2] < 10)).all()
    whole = together(edges, legs)
    of = [{tuple(each) for each in whole[whole.part == part].voxels.tolist()} for part in (0, 1)]
    assert not of[0] & of[1]


FIELD = st.lists(
    st.tuples(st.integers(1, 6), st.integers(1, 12), st.integers(4, 45)),
    min_size=1,
    max_size=9,
    unique_by=lambda c: c[:2],
)
BLOCKED = st.lists(st.tuples(st.integers(0, 12), st.integers(0, 24), st.integers(0, 50)), max_size=40)


@given(FIELD, BLOCKED)
@examples(15)
def test_random_fields_of_columns_have_no_long_leg_but_those_that_are_listed(field, blocked):
    grid, voxels = empty_grid()
    for y, x, k in blocked:
        voxels[k : k + 4, y : y + 2, x : x + 2] = Voxel.CLOSED
    columns = [(2 * y, 2 * x, top) for y, x, top in field if (voxels[:top, 2 * y, 2 * x] == Voxel.FREE).all()]
    assume(columns)
    edges = SupportEdges.from_rows([row for y, x, top in columns for row in column(y, x, top)])
    held = [(top, y, x) for y, x, top in columns]
    legs = shorten(grid, voxels, edges, held)
    assert legs.left or worst_ratio(together(edges, legs), held) <= 10
    assert (voxels[tuple(legs.edges.voxels.T)] == Voxel.FREE).all()
    again = shorten(grid, voxels, edges, held)
    np.testing.assert_array_equal(legs.edges.upper, again.edges.upper)


def test_columns_in_open_space_can_always_be_mended():
    grid, voxels = empty_grid()
    rng = np.random.default_rng(0)
    for _ in range(10):
        spots = rng.permutation(6 * 13)[:5]
        columns = [(2 * int(s // 13) + 1, 2 * int(s % 13) + 2, int(rng.integers(12, 50))) for s in spots]
        edges = SupportEdges.from_rows([row for y, x, top in columns for row in column(y, x, top)])
        assert shorten(grid, voxels, edges, [(top, y, x) for y, x, top in columns]).left == ()


@pytest.mark.parametrize(("walls", "is_much"), [(1, True), (20, False)])
def test_the_note_states_how_much_bracing_adds_and_proposes_wider_supports_above_a_quarter(walls, is_much):
    grid, voxels = empty_grid()
    wall = [row for y in range(walls) for x in (22, 23, 24) for row in column(y, x, 9)]
    routed = SupportEdges.from_rows(column(7, 7, 19) + wall)
    red = [(19, 7, 7), *((9, y, x) for y in range(walls) for x in (22, 23, 24))]
    legs = kept_short(grid, voxels, routed, red)
    assert not legs.lost.any()
    assert len(legs.edges) == pytest.approx((1 + legs.added) * len(routed))
    assert (legs.added > 0.25) == is_much
    (words,) = words_of(legs, 10.0)
    assert (
        f"this adds {100 * (len(legs.edges) / len(routed) - 1):.0f} % to the edges of the supports" in words
    )
    assert ("wider cell" in words) == is_much
