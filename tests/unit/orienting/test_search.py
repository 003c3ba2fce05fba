"""Proposals of orientations: rotations with true figures that no other one beats, within the restrictions."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from amprep.checks.orientation import check_proposal
from amprep.errors import JobError
from amprep.model import Stop
from amprep.model.mesh import Mesh
from amprep.model.orientation import OrientationRules
from amprep.model.part import Part
from amprep.model.supports.rules import SupportRules
from amprep.orienting.search import OrientationSearch, propose_orientations

METAL = SupportRules(rules="limits", ledge_mm=1.0, bridge_mm=2.0, bore_mm=8.0, plate_mm=0.06)
FEW = OrientationSearch(measured=6)


def part_of(solid):
    return Part("part", Mesh(solid.vertices, solid.faces), float(solid.volume))


def table():
    """A top of 20 x 20 x 2 mm on a leg of 4 x 4 x 10 mm, drawn on its leg."""
    top = trimesh.creation.box(bounds=[[-10, -10, 10], [10, 10, 12]])
    return part_of(trimesh.boolean.union([top, trimesh.creation.box(bounds=[[-2, -2, 0], [2, 2, 11]])]))


@pytest.fixture(scope="module")
def found():
    return propose_orientations(table(), METAL, 0.0, OrientationRules(), FEW, stop=Stop())


def test_a_table_is_built_upside_down_without_supports(found):
    best = found.proposals[0]
    assert best.rotation[2].tolist() == [0.0, 0.0, -1.0]
    assert (best.figures.overhang_mm2, best.figures.shadow_mm3) == (0.0, 0.0)
    assert best.figures.contact_mm2 == pytest.approx(400)
    assert found.drawn.figures.overhang_mm2 > 300
    assert found.tried >= 1000


def test_every_proposal_keeps_its_promises(found):
    assert len(found.proposals) == 5
    for proposal in (found.drawn, *found.proposals[:2]):
        assert check_proposal(table(), proposal, METAL, 0.0) == []


def test_proposals_look_in_different_directions_and_each_merit_has_one(found):
    up = np.array([proposal.rotation[2] for proposal in found.proposals])
    assert (up @ up.T - 2 * np.eye(len(up))).max() < np.cos(np.radians(5.0)) + 1e-9
    merits = [merit for proposal in found.proposals for merit in proposal.merits]
    assert sorted(merits) == ["balance", "box", "height", "overhang", "stability", "support"]


def smallest_by_brute_force(points):
    """Return the least volume of boxes with a side along a face and another along an edge of the hull."""
    hull = ConvexHull(points)
    ends = np.concatenate([hull.simplices[:, [0, 1]], hull.simplices[:, [1, 2]], hull.simplices[:, [2, 0]]])
    along = points[ends[:, 1]] - points[ends[:, 0]]
    best = np.inf
    for normal in hull.equations[:, :3]:
        level = along - np.outer(along @ normal, normal)
        level = level[np.linalg.norm(level, axis=1) > 1e-9]
        level /= np.linalg.norm(level, axis=1)[:, None]
        sides = np.ptp(points @ level.T, axis=0) * np.ptp(points @ np.cross(normal, level).T, axis=0)
        best = min(best, np.ptp(points @ normal) * sides.min())
    return best


@pytest.mark.parametrize("seed", range(3))
def test_a_proposal_has_a_box_no_larger_than_all_along_faces_of_the_hull(seed):
    points = np.random.default_rng(seed).normal(size=(14, 3)) * [3.0, 7.0, 11.0]
    solid = trimesh.convex.convex_hull(points)
    proposals = propose_orientations(
        part_of(solid), METAL, 0.0, OrientationRules(), FEW, stop=Stop()
    ).proposals
    least = min(proposal.figures.box_mm3 for proposal in proposals)
    assert solid.volume < least <= smallest_by_brute_force(solid.vertices) * (1 + 1e-6)


@pytest.mark.parametrize(
    ("rules", "holds"),
    [
        (OrientationRules(face_up=("-z",)), lambda up: -up[2] >= np.cos(np.pi / 4) - 1e-6),
        (OrientationRules(face_down=("+x",)), lambda up: -up[0] >= np.cos(np.pi / 4) - 1e-6),
        (OrientationRules(tilt_deg=30.0), lambda up: up[2] >= np.cos(np.pi / 6) - 1e-6),
    ],
    ids=["up", "down", "tilt"],
)
def test_restrictions_hold_for_every_proposal(rules, holds):
    proposals = propose_orientations(table(), METAL, 0.0, rules, FEW, stop=Stop()).proposals
    assert proposals
    assert all(holds(proposal.rotation[2]) for proposal in proposals)


def test_faces_that_nothing_may_touch_are_neither_overhangs_nor_on_the_plate():
    rules = OrientationRules(no_contact=("+z",))
    proposals = propose_orientations(table(), METAL, 0.0, rules, FEW, stop=Stop()).proposals
    # a top that nothing may touch must not look down by more than the overhang angle
    assert all(proposal.rotation[2, 2] >= -np.cos(np.radians(44.9)) for proposal in proposals)


def test_restrictions_without_an_allowed_orientation_are_refused():
    rules = OrientationRules(face_up=("+z",), face_down=("+z",))
    with pytest.raises(JobError, match="no allowed orientation"):
        propose_orientations(table(), METAL, 0.0, rules, FEW, stop=Stop())


def test_faces_that_the_part_does_not_have_are_refused_with_a_hint():
    with pytest.raises(JobError, match=r"no faces called 'z\+'"):
        propose_orientations(table(), METAL, 0.0, OrientationRules(face_up=("z+",)), FEW, stop=Stop())


def test_a_part_that_fits_in_no_orientation_is_refused():
    settings = FEW._replace(fits=lambda rotations: np.zeros(len(rotations), bool))
    with pytest.raises(JobError, match="fits the build volume in none"):
        propose_orientations(table(), METAL, 0.0, OrientationRules(), settings, stop=Stop())


def test_a_stopped_search_returns_what_it_has():
    found = propose_orientations(table(), METAL, 0.0, OrientationRules(), FEW, stop=Stop.after(0.0))
    assert len(found.proposals) == 1


def test_the_same_part_gets_the_same_proposals(found):
    again = propose_orientations(table(), METAL, 0.0, OrientationRules(), FEW, stop=Stop())
    assert [each.rotation.tolist() for each in again.proposals] == [
        each.rotation.tolist() for each in found.proposals
    ]


def test_planned_supports_order_the_proposals_and_what_stays_unsupported_comes_last():
    asked = []

    def routed(part, rotation):
        asked.append(rotation)
        # the more tilted, the fewer supports; but upside down something stays unsupported
        return 1000.0 * (1.0 + rotation[2, 2]), int(rotation[2, 2] < -0.9)

    settings = FEW._replace(routed=routed, compared=2)
    found = propose_orientations(table(), METAL, 0.0, OrientationRules(), settings, stop=Stop())
    figures = [each.figures for each in found.proposals]
    assert found.drawn.figures.support_mm3 == pytest.approx(2000)
    assert all(each.support_mm3 is not None for each in figures)
    costs = [(each.support_mm3 or 0.0) + each.hold_mm3 for each in figures if not each.unsupported]
    assert costs == sorted(costs)
    assert [each.unsupported > 0 for each in figures] == sorted(each.unsupported > 0 for each in figures)
    # the part as drawn, two of the others, and the proposals among which these may be
    assert 6 <= len(asked) <= 8
