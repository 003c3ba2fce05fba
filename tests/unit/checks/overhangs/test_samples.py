"""The judge's own search for overhangs agrees with the planner's, which shares no code with it."""

import manifold3d
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.builds import box_mesh
from tests.shared.examples import examples

from amprep.checks.overhangs.samples import KINDS, judged_overhangs
from amprep.geometry.meshes.sampling import sample_overhangs
from amprep.model import Mesh, Overrides, Part, PlacedPart, Region
from amprep.model.supports import SupportRules
from amprep.overhangs.of_part import overhangs_of

Solid = manifold3d.Manifold
SPACING = 0.5


def placed(solid, **settings):
    mesh = solid.to_mesh()
    part = Part("p", Mesh(mesh.vert_properties[:, :3], mesh.tri_verts), solid.volume(), **settings)
    return PlacedPart("p", part, np.eye(4))


def by_kind(samples, kinds):
    return {
        kind: {tuple(point) for point in np.round(samples.points[kinds == kind], 5).tolist()}
        for kind in KINDS
    }


def judged(part, rules):
    samples = judged_overhangs(part, rules, SPACING).samples
    return by_kind(samples, np.array(KINDS)[samples.kind])


def planned(part, rules):
    own = overhangs_of(part, rules)
    samples = sample_overhangs(own.mesh.vertices, own.mesh.triangles, own.overhangs, SPACING)
    kinds = np.array([region.kind for region in own.overhangs.regions], dtype=object)
    return by_kind(samples, kinds[samples.region] if len(kinds) else np.empty(0, object))


angles = st.floats(-180, 180).map(lambda angle: round(angle, 1))
boxes = st.tuples(st.tuples(angles, angles, angles), st.tuples(*[st.floats(-6, 6)] * 3), st.floats(2, 9))


@given(st.lists(boxes, min_size=1, max_size=4), st.floats(20, 70))
@examples(40)
def test_both_searches_find_the_same_points_on_unions_of_turned_boxes(turned, angle):
    solid = Solid.batch_boolean(
        [Solid.cube((5, 7, 0.7 * z), True).rotate(turn).translate(at) for turn, at, z in turned],
        manifold3d.OpType.Add,
    ).translate((20, 20, 14))
    part = placed(solid)
    limits = SupportRules(overhang_angle_deg=angle, min_area_mm2=0.0, min_length_mm=0.0)
    found, expected = judged(part, limits), planned(part, limits)
    for kind in KINDS:
        assert found[kind] == expected[kind]


@pytest.mark.parametrize(
    ("solid", "kind"),
    [
        (Solid.cube((10, 10, 10), True).translate((0, 0, 20)), "face"),
        (Solid.cube((10, 10, 10), True).rotate((45, 0, 0)).translate((0, 0, 20)), "edge"),
        (Solid.cylinder(20, 0, 5, 24).translate((0, 0, 4)), "tip"),
    ],
)
def test_each_kind_is_found_on_a_body_that_has_only_that(solid, kind):
    found = judged(placed(solid), SupportRules())
    assert {name for name, points in found.items() if points} == {kind}


def test_pits_are_no_tips_and_notches_no_knife_edges():
    pit = Solid.cylinder(6, 0, 5, 24).translate((0, 0, 4.5))
    notch = Solid.cube((30, 4, 4), True).rotate((45, 0, 0)).translate((0, 6, 10))
    found = judged(placed(Solid.cube((20, 20, 10), True).translate((0, 0, 5)) - pit - notch), SupportRules())
    assert not any(found.values())


def test_small_faces_count_only_where_the_part_starts_in_the_air():
    ledge = Solid.cube((10, 10, 20)) + Solid.cube((0.5, 0.5, 2)).translate((10, 4, 12))
    hanging = Solid.cube((10, 10, 20)) + Solid.cube((3, 0.5, 0.5)).rotate((0, 45, 0)).translate((9.5, 4, 14))
    rules = SupportRules(min_area_mm2=1.0, min_length_mm=9.0)
    for solid in (ledge, hanging):
        assert judged(placed(solid), rules) == planned(placed(solid), rules)


def test_a_part_without_supports_has_no_samples():
    solid = Solid.cube((10, 10, 10)).translate((0, 0, 5))
    assert (
        len(
            judged_overhangs(
                placed(solid, overrides=Overrides(supports=False)), SupportRules(), 1.0
            ).samples.points
        )
        == 0
    )


def test_blockers_remove_and_enforcers_add_points_up_to_the_uncertainty_of_their_borders():
    slab = Solid.cube((20, 20, 3)).translate((0, 0, 10))
    blocker = Region("blocker", "b", mesh=box_mesh((-1, -1, 9), (11, 22, 2)))
    points = judged_overhangs(placed(slab, regions=(blocker,)), SupportRules(), SPACING).samples.points
    assert 10.7 < points[:, 0].min() < 11.4
    enforcer = Region("enforcer", "e", mesh=box_mesh((-1, -1, -1), (40, 40, 10)))
    steep = Solid.cylinder(20, 5, 9, 64).translate((15, 15, 0))
    assert len(judged_overhangs(placed(steep), SupportRules(), SPACING).samples.points) == 0
    points = judged_overhangs(placed(steep, regions=(enforcer,)), SupportRules(), SPACING).samples.points
    assert 7.5 < points[:, 2].max() < 9.0
