"""Bodies of one part that touch face to face have no overhang between them."""

import numpy as np
import pytest
from manifold3d import Manifold
from tests.shared.layouts import box, placed
from tests.shared.solids import stacked

from amprep.checks.overhangs.needs import are_needed
from amprep.checks.overhangs.samples import judged_overhangs
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.geometry.overhangs.joints import join_touching
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.of_part import overhangs_of

LIMITS = SupportRules(rules="limits", ledge_mm=2.0, bridge_mm=4.0, bore_mm=10.0)
BASE = box((10, 10, 5), (0, 0, 0))


def part_of(*bodies):
    (part,) = placed(stacked(*bodies))
    return part


def verdicts(part, rules=LIMITS):
    """Kind, size, whether the part starts in the air there, and whether it carries the region."""
    regions = overhangs_of(part, rules).overhangs.regions
    return [
        (each.kind, round(each.size_mm, 1), each.starts_in_air, each.is_self_supporting) for each in regions
    ]


def judged_points(part):
    """Points that need a contact, as the judge sees it."""
    found = judged_overhangs(part, LIMITS, 0.5)
    return found.samples.points[are_needed(found, LIMITS, np.arange(len(found.samples.points)))]


@pytest.mark.parametrize("gap", [0.0, 0.001])
@pytest.mark.parametrize(
    "size", [(6, 6, 5), (10, 10, 5), (10, 4, 5)], ids=["smaller", "equal", "flush on two sides"]
)
def test_what_stands_on_another_body_is_no_overhang(size, gap):
    part = part_of(BASE, box(size, ((10 - size[0]) / 2, (10 - size[1]) / 2, 5 + gap)))
    assert verdicts(part) == []
    assert len(judged_points(part)) == 0


@pytest.mark.parametrize("gap", [0.0, 0.001])
def test_a_body_is_a_ledge_where_it_extends_beyond_the_body_below(gap):
    short, long = (part_of(BASE, box((10 + over, 10, 5), (0, 0, 5 + gap))) for over in (1.5, 4.0))
    assert verdicts(short) == [("ledge", 1.5, False, True)]
    assert len(judged_points(short)) == 0
    assert verdicts(long) == [("ledge", 4.0, False, False)]
    assert judged_points(long)[:, 0].min() == pytest.approx(12.1, abs=0.5)
    assert judged_points(long)[:, 0].max() == pytest.approx(14.0, abs=0.01)


def test_two_bodies_carry_a_bridge():
    (narrow, wide) = (
        part_of(BASE, box((10, 10, 5), (10 + span, 0, 0)), box((20 + span, 10, 3), (0, 0, 5)))
        for span in (3.0, 6.0)
    )
    assert verdicts(narrow) == [("bridge", 3.0, False, True)]
    assert len(judged_points(narrow)) == 0
    assert verdicts(wide) == [("bridge", 6.0, False, False)]
    assert len(judged_points(wide)) > 0


def test_a_body_above_a_gap_of_more_than_a_layer_starts_in_the_air():
    part = part_of(BASE, box((6, 6, 5), (2, 2, 5.05)))
    assert verdicts(part) == [("flat", 0.0, True, False)]
    assert np.allclose(judged_points(part)[:, 2], 5.05)
    assert len(judged_points(part)) > 100


def test_a_part_without_level_faces_has_nothing_to_join():
    ball = Manifold.sphere(5.0, 16).rotate((3.0, 5.0, 7.0)).to_mesh64()
    assert join_touching(ball.vert_properties[:, :3], ball.tri_verts.astype(np.int64)) is None


def test_faces_beside_each_other_at_one_height_do_not_touch():
    part = part_of(BASE, box((6, 6, 5), (11, 2, 5)))
    assert join_touching(part.mesh.vertices, part.mesh.triangles) is None
    assert [kind for kind, *_ in verdicts(part)] == ["flat"]
    assert len(judged_points(part)) > 0


def test_the_angle_alone_counts_by_the_rules_of_the_thesis():
    part = part_of(BASE, box((6, 6, 5), (2, 2, 5)))
    assert [kind for kind, *_ in verdicts(part, SupportRules())] == ["face"]


@pytest.mark.parametrize("gap", [0.0, 0.001])
def test_joined_bodies_are_one_solid_of_their_common_volume(gap):
    part = part_of(BASE, box((6, 6, 5), (7, 7, 5 + gap)))
    found = join_touching(part.mesh.vertices, part.mesh.triangles)
    assert found is not None
    joined = as_manifold(*found)
    assert accepted(joined)
    assert len(joined.decompose()) == 1
    assert joined.volume() == pytest.approx(500 + 180 + 9 * gap, abs=1e-4)
