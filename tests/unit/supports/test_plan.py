"""Grid, red squares and the whole plan, on builds whose supports can be drawn by hand."""

import manifold3d
import numpy as np
import pytest
from tests.shared.layouts import SPACE, Solid, box, layout, mesh_of, placed, route

from amprep.errors import JobError, PluginError
from amprep.model import (
    BuildVolume,
    Overrides,
    Region,
    Stop,
    SupportEdges,
    SupportPlan,
)
from amprep.model.supports import (
    CAPACITY,
    CONNECTOR_BLOCKED,
    ENCLOSED,
    NO_FREE_VOXEL_BELOW,
    OUT_OF_TIME,
    Voxel,
)
from amprep.plugins.routers.auto import route_auto
from amprep.supports.grid.sizing import choose_pitch
from amprep.supports.plan import PlanningRules


def columns(plan):
    """Red squares as ``(plane, y, x)`` in whole-volume indices."""
    x0, y0, _ = np.round(plan.grid.origin / plan.grid.pitch).astype(int)
    return {(p, y + y0, x + x0) for p, y, x in plan.red.square.tolist()}


TABLE = box((20, 20, 3), (20, 20, 10)) + box((6, 6, 10), (27, 27, 0))


def test_a_table_has_a_red_square_under_every_cube_of_its_slab_beside_the_leg():
    plan = layout(placed(TABLE))
    assert columns(plan) == {
        (10, y, x) for y in range(20, 40) for x in range(20, 40) if not (27 <= y < 33 and 27 <= x < 33)
    }
    assert plan.connected.all()
    assert set(plan.red.rise.tolist()) == {1}
    assert plan.group_parts == ((0,),)
    assert set(plan.edges.group.tolist()) == {0}
    assert plan.grid.shape[0] == 11  # no higher than the highest overhang's voxel


def test_what_lies_in_the_layer_on_the_plate_is_connected_directly():
    plan = layout(placed(box((5, 4, 3), (10, 10, 0.5))))
    assert columns(plan) == {(0, y, x) for y in range(10, 14) for x in range(10, 15)}
    assert plan.connected.all()
    assert len(plan.edges.flow) == 0
    assert set(plan.red_group.tolist()) == {0}


def test_a_part_on_the_plate_without_overhangs_gets_nothing():
    plan = layout(placed(box((5, 4, 3), (10, 10, 0))))
    assert len(plan.red.square) == 0
    assert plan.group_parts == ()


def test_a_build_without_parts_gets_an_empty_layout():
    assert len(layout([]).red.square) == 0


def test_a_knife_edge_gets_red_squares_along_it():
    wedge = Solid.hull_points(
        [(10.2, 20.5, 8.5), (18.8, 20.5, 8.5)] + [(x, y, 20) for x in (10.2, 18.8) for y in (17, 24)]
    )
    assert columns(layout(placed(wedge))) == {(8, 20, x) for x in range(10, 19)}


def test_a_tip_gets_one_red_square():
    assert columns(layout(placed(Solid.cylinder(20, 0, 4, 16).translate((20.5, 30.5, 6))))) == {(6, 30, 20)}


def test_the_rise_counts_the_cubes_that_the_connector_may_pass():
    """A ramp of 26.6 degrees over squares of 1 mm: in every other column its face passes two voxels."""
    side = [(0, 8.25), (12, 14.25), (12, 18), (0, 18)]
    ramp = Solid.extrude(manifold3d.CrossSection([side]), 2).rotate((90, 0, 0)).translate((20, 22, 0))
    plan = layout(placed(ramp))
    assert plan.red.square[np.argsort(plan.red.square[:, 2])][::2, 0].tolist() == [
        8,
        8,
        9,
        9,
        10,
        10,
        11,
        11,
        12,
        12,
        13,
        13,
    ]
    assert plan.red.rise[np.argsort(plan.red.square[:, 2])][::2].tolist() == [
        1,
        2,
        1,
        2,
        1,
        2,
        1,
        2,
        1,
        2,
        1,
        2,
    ]


def test_a_ceiling_in_a_closed_room_is_listed_as_enclosed():
    room = box((12, 12, 12), (10, 10, 0)) - box((6, 6, 6), (13, 13, 3))
    plan = layout(placed(room))
    assert columns(plan) == {(9, y, x) for y in range(13, 19) for x in range(13, 19)}
    assert set(plan.reasons) == {ENCLOSED}
    assert not plan.connected.any()
    assert plan.reason_at(0, np.array([[15.0, 15.2, 9.0]])) == (ENCLOSED,)
    rim = np.array([[13.0, 15.2, 9.0], [19.0, 15.2, 9.0], [15.2, 19.0, 9.0], [19.0, 19.0, 9.0]])
    assert plan.reason_at(0, rim) == (ENCLOSED,) * 4, "the ceiling is on one side of the lines of the grid"


def test_an_overhang_right_above_material_is_listed_as_no_free_voxel_below():
    slot = box((12, 12, 12), (10, 10, 0)) - box((6, 12, 0.5), (13, 10, 5.2))
    plan = layout(placed(slot))
    assert len(plan.red.square) == 0
    assert plan.reason_at(0, np.array([[15.0, 15.2, 5.7]])) == (NO_FREE_VOXEL_BELOW,)


def test_the_reason_of_a_square_is_not_that_of_an_overhang_higher_up_in_its_column():
    room = box((12, 12, 12), (10, 10, 0)) - box((6, 6, 4), (13, 13, 2)) - box((6, 6, 0.5), (13, 13, 9.2))
    plan = layout(placed(room))
    assert plan.reason_at(0, np.array([[15.0, 15.2, 6.0], [15.0, 15.2, 9.7]])) == (
        ENCLOSED,
        NO_FREE_VOXEL_BELOW,
    )


def test_what_a_connected_red_square_does_not_hold_is_a_blocked_connector():
    plan = layout(placed(TABLE))
    assert plan.reason_at(0, np.array([[21.5, 21.5, 10.0], [30.0, 30.0, 10.0]])) == (
        CONNECTOR_BLOCKED,
        NO_FREE_VOXEL_BELOW,
    )


def test_paths_lead_out_of_a_hole_sideways():
    """A T above a blind hole, open to one side: the squares over the hole go round through the opening."""
    block = box((12, 12, 6), (10, 10, 0)) - box((4, 9, 4), (14, 13, 2))
    roof = box((12, 12, 2), (10, 10, 14)) + box((2, 2, 8), (10, 10, 6))
    plan = layout(placed(block + roof))
    over_block = (plan.red.square[:, 0] == 14).sum()
    assert over_block == 144 - 4
    assert plan.connected.all()


def two_balls():
    lower, upper = (Solid.sphere(6, 48).translate((30, 30, z)) for z in (9, 30))
    return placed(lower, upper)


def test_two_balls_above_one_another_share_nothing_by_default():
    plan = layout(two_balls())
    assert plan.connected.all()
    assert plan.group_parts == ((0,), (1,))
    assert plan.notes == ()
    used = [set(map(tuple, plan.edges[plan.edges.part == part].voxels.tolist())) for part in (0, 1)]
    assert not used[0] & used[1]


def shaft(width):
    """A chamber with two plates, one above the other and beside it, over a narrow way down to the plate."""
    well = (
        box((14, 14, 30), (10, 10, 0)) - box((width, width, 30), (16, 16, 0)) - box((8, 8, 20), (13, 13, 10))
    )
    return placed(well, box((8, 2, 1), (13, 13, 20)), box((8, 2, 1), (13, 18, 24)))


def test_supports_are_shared_only_where_there_is_no_other_way():
    plan = layout(shaft(1), min_area_mm2=0.0)
    assert plan.connected.all()
    assert plan.group_parts == ((1, 2),)
    assert plan.shared == ("share supports: p1, p2",)
    assert plan.edges.flow.max() == 32
    apart = layout(shaft(5), min_area_mm2=0.0)
    assert apart.connected.all()
    assert apart.group_parts == ((1,), (2,))


def test_two_parts_may_need_the_same_square():
    """Two boxes with 0.2 mm between them, in the middle of a row of voxels, share the squares below it."""
    pair = placed(box((4.4, 3, 2), (10, 10, 20)), box((4.4, 3, 2), (14.6, 10, 20)))
    plan = layout(pair)
    assert plan.connected.all()
    _, count = np.unique(plan.red.square, axis=0, return_counts=True)
    assert (count == 2).sum() == 3
    assert plan.group_parts == ((0, 1),)


def test_one_network_may_be_asked_for():
    plan = layout(two_balls(), share_between_parts="allow")
    assert plan.connected.all()
    key = np.column_stack([plan.edges.upper, plan.edges.direction])
    assert len(np.unique(key, axis=0)) == len(key)


@pytest.mark.parametrize("share", ["avoid", "allow"])
def test_capacities_hold_for_the_whole_build(share):
    plan = layout(shaft(2), share_between_parts=share, node_capacity=3, min_area_mm2=0.0)
    assert plan.connected.sum() == 12  # the shaft has four squares of at most three paths each
    assert {reason for reason in plan.reasons if reason} == {CAPACITY}
    _, square = np.unique(plan.edges.upper, axis=0, return_inverse=True)
    assert np.bincount(square.reshape(-1), weights=plan.edges.flow).max() <= 3


def test_notes_say_what_the_router_says_that_capacities_are_raised_and_that_time_is_up():
    def auto(problem, stop, progress):
        return route_auto(problem, rng=np.random.default_rng(0), stop=stop, progress=progress)

    plan = layout(shaft(2), route=auto, node_capacity=3, escalation="cut", min_area_mm2=0.0)
    assert plan.connected.all()
    assert any(note.startswith("p1: auto chose the router tree") for note in plan.notes)
    assert (
        "capacities are raised by up to 5, as supports.escalation allows" in plan.notes
    )  # 32 paths, 4 squares
    late = layout(placed(TABLE), route=auto, stop=Stop.after(0.0))
    assert "p0: routing ended early: time limit" in late.notes


def test_cubes_outside_the_build_volume_are_closed():
    drum = BuildVolume([40, 40, 40], shape="cylinder")
    plan = layout(placed(box((20, 20, 2), (10, 10, 20))), space=drum)
    x0, y0, _ = plan.grid.origin
    for y, x in np.ndindex(plan.voxels.shape[1:]):
        far = max(np.hypot(x0 + x + i - 20, y0 + y + j - 20) for i in (0, 1) for j in (0, 1))
        assert (plan.voxels[0, y, x] == Voxel.CLOSED) == (far > 20.001)


def test_forbidden_zones_are_closed_and_gone_round():
    zone = {"zone_lo": [[12, 12, 0]], "zone_hi": [[18, 18, 5.5]]}
    plan = layout(placed(box((4, 4, 2), (13, 13, 20))), space=BuildVolume([60, 60, 60], **zone))
    x0, y0, _ = plan.grid.origin.astype(int)
    closed = np.zeros(plan.voxels.shape, bool)
    closed[0:6, 12 - y0 : 18 - y0, 12 - x0 : 18 - x0] = True
    assert ((plan.voxels == Voxel.CLOSED) == closed).all()
    assert plan.connected.all()


def test_the_grid_ends_inside_the_box_and_is_shifted_to_a_wall_where_a_part_stands():
    space = BuildVolume([40.5, 60, 60])
    plan = layout(placed(box((10, 10, 2), (30.5, 20, 10))), space=space)
    end = plan.grid.origin[0] + plan.grid.shape[2] * plan.grid.pitch
    assert end == pytest.approx(40.5)
    assert len(plan.red.square) == 100
    assert plan.connected.all()
    free = layout(placed(box((10, 10, 2), (20, 20, 10))), space=space)
    assert free.grid.origin[0] + free.grid.shape[2] * free.grid.pitch <= 40.5


def test_the_strut_angle_sets_the_step():
    assert layout(placed(TABLE), strut_angle_deg=60.0).grid.step == pytest.approx(np.sqrt(3))


def test_a_part_may_have_its_own_angle_or_no_supports():
    ball = Solid.sphere(6, 48).translate((30, 30, 12))
    usual = len(layout(placed(ball)).red.square)
    flat = layout(placed(ball, overrides=Overrides(overhang_angle_deg=20.0)))
    assert 0 < len(flat.red.square) < usual
    none = layout(placed(ball, overrides=Overrides(supports=False)))
    assert len(none.red.square) == 0
    assert none.voxels.max(initial=0) == 0 or (none.voxels == Voxel.OCCUPIED).any()


def test_a_blocker_mesh_takes_needs_away_and_enforcer_triangles_add_some():
    table = mesh_of(TABLE)
    below = table.vertices[table.triangles][:, :, 2].max(axis=1) == 10
    blocker = Region("blocker", "none here", triangles=np.flatnonzero(below).astype(np.int32))
    assert len(layout(placed(TABLE, regions=(blocker,))).red.square) == 0
    away = Region("blocker", "elsewhere", mesh=mesh_of(box((5, 5, 5), (50, 50, 50))))
    assert len(layout(placed(TABLE, regions=(away,))).red.square) == 364
    around = Region("blocker", "all", mesh=mesh_of(box((30, 30, 30), (15, 15, -5))))
    assert len(layout(placed(TABLE, regions=(around,))).red.square) == 0
    cone = Solid.cylinder(10, 6, 10, 32).translate((30, 30, 0))  # its side looks down at 68 degrees
    assert len(layout(placed(cone)).red.square) == 0
    mesh = mesh_of(cone)
    low = np.flatnonzero(mesh.vertices[mesh.triangles][:, :, 2].min(axis=1) < 1).astype(np.int32)
    assert len(layout(placed(cone, regions=(Region("enforcer", "side", triangles=low),))).red.square) > 0


def test_a_gap_keeps_paths_away_from_walls_but_not_from_their_own_overhang():
    post = box((4, 4, 30), (28, 28, 0))
    slab = box((14, 4, 2), (32, 28, 20))
    free, kept = (layout(placed(post + slab), gap_mm=gap) for gap in (0.0, 2.0))
    assert free.connected.all()
    x0, y0, _ = kept.grid.origin.astype(int)
    x, y = kept.edges.x + x0, kept.edges.y + y0
    low = kept.edges.plane <= 15
    assert ((x[low] >= 34) | (y[low] < 26) | (y[low] >= 34)).all()
    far = kept.red.square[:, 2] + x0 >= 34
    assert kept.connected[far].all()


def test_a_gap_of_any_width_leaves_what_can_stand_below_its_overhang():
    plan = layout(placed(TABLE), gap_mm=1e9)
    assert plan.connected.all()
    assert set(zip(plan.edges.y, plan.edges.x, strict=True)) <= {
        (y, x) for _, y, x in plan.red.square.tolist()
    }


def test_the_automatic_pitch_suits_the_part_and_bounds_memory():
    def pitch(size, space=SPACE):
        return choose_pitch(placed(box(size, (0, 0, 0))), space, PlanningRules())

    assert pitch((30, 30, 30)) == 2.0
    assert pitch((15, 15, 15)) == 1.2
    assert pitch((4, 4, 4)) == 0.8
    assert pitch((700, 700, 700), BuildVolume([800, 800, 800])) > 1.5
    assert choose_pitch([], SPACE, PlanningRules()) == 2.0


def test_a_pitch_far_too_fine_is_refused():
    with pytest.raises(JobError, match="choose a larger pitch"):
        layout(placed(TABLE), pitch_mm=0.02)


def test_a_router_that_breaks_its_promise_is_refused():
    def lazy(problem, stop, progress):
        return SupportPlan(SupportEdges.from_rows([]))

    with pytest.raises(PluginError, match="broke its promise"):
        layout(placed(TABLE), route=lazy)


def test_the_same_build_gives_the_same_layout():
    first, second = layout(two_balls()), layout(two_balls())
    for one, other in zip((*first.red, first.red_group), (*second.red, second.red_group), strict=True):
        assert one.tolist() == other.tolist()
    for name in ("upper", "direction", "flow", "capacity", "part", "group"):
        assert getattr(first.edges, name).tolist() == getattr(second.edges, name).tolist()


def test_the_automatic_pitch_keeps_to_the_memory_allowed_and_a_given_one_is_refused_with_advice():
    part, space = placed(box((300, 300, 300), (50, 50, 20))), BuildVolume([400, 400, 400])
    pitches = [choose_pitch(part, space, PlanningRules(memory_mb=memory)) for memory in (60, 150, 2000)]
    assert pitches[0] > pitches[1] > pitches[2] == 2.0
    layout(part, space=space, pitch_mm=pitches[0], memory_mb=60)
    with pytest.raises(JobError, match=r"supports.memory_mb = 60.*--set supports.pitch_mm=") as refused:
        layout(part, space=space, pitch_mm=0.5, memory_mb=60)
    advised = float(str(refused.value).partition("pitch_mm=")[2].split(")")[0])
    layout(part, space=space, pitch_mm=advised, memory_mb=60)


def test_each_part_gets_its_share_of_the_time_and_what_is_not_routed_is_listed():
    given = []

    def remember(problem, stop, progress):
        given.append(stop.remaining())
        return route(problem, stop, progress)

    pair = placed(box((9, 9, 2), (5, 5, 12)), box((9, 9, 2), (30, 30, 20)))
    assert layout(pair, route=remember, stop=Stop.after(100.0)).connected.all()
    assert given[0] <= 50.0 < given[1]
    late = layout(pair, route=remember, stop=Stop.after(-1.0))
    assert len(given) == 2
    assert set(late.reasons) == {OUT_OF_TIME}


def test_what_is_left_over_is_connected_beside_the_flow_of_other_parts():
    """Of two slabs above one shaft the upper one is left over, until capacities grow around both flows."""
    plan = layout(shaft(2), node_capacity=3, escalation="cut", min_area_mm2=0.0)
    assert plan.connected.all()
    squares, number = np.unique(plan.edges.upper, axis=0, return_inverse=True)
    through = np.bincount(number.reshape(-1), weights=plan.edges.flow)
    assert through.max() == 8  # 32 paths over the four squares of the shaft
    arriving = {tuple(square): 0 for square in squares.tolist()}
    for square, flow in zip(plan.edges.lower.tolist(), plan.edges.flow.tolist(), strict=True):
        arriving[tuple(square)] = arriving.get(tuple(square), 0) + flow
    red = {tuple(square) for square in plan.red.square.tolist()}
    for square, flow in zip(squares.tolist(), through.tolist(), strict=True):
        assert flow == arriving[tuple(square)] + (tuple(square) in red)


def test_what_is_left_over_is_routed_again_where_capacities_were_raised():
    """The paths that the capacity of 5 has led around the shaft took 369 edges in all."""
    plan = layout(shaft(2), node_capacity=5, escalation="cut", min_area_mm2=0.0)
    assert plan.connected.all()
    assert len(plan.edges) <= 304
    _, number = np.unique(plan.edges.upper, axis=0, return_inverse=True)
    assert np.bincount(number.reshape(-1), weights=plan.edges.flow).max() == 8
