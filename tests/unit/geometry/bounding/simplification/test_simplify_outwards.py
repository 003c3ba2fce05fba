"""Simplified meshes contain the original, are closed and do not intersect themselves, as other libraries see them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from tests.shared.examples import examples
from tests.shared.solids import PRINTABLE, arrays, gyroid, random_solid, screw_plate

from amprep.geometry.bounding.simplification.simplify_outwards import simplify_outwards
from amprep.geometry.meshes.manifold import accepted, as_manifold

pytestmark = pytest.mark.compiled

SEEDS = st.integers(0, 10**6)
COSTS = ("volume", "distance")


def assert_contains(solid, simplified):
    """Assert that the mesh is a solid in which nothing of the first one is missing."""
    bounding = as_manifold(simplified.vertices, simplified.triangles)
    assert accepted(bounding)
    assert (solid - bounding).volume() == pytest.approx(0.0, abs=1e-9)
    assert bounding.volume() >= solid.volume() * (1 - 1e-12)


def crossings(vertices, triangles):
    """Count the edges that pierce a triangle with which they share no vertex, pair by pair."""
    edges = np.unique(
        np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1),
        axis=0,
    )
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    found = 0
    for p, q in edges:
        one = np.einsum("ij,ij->i", normal, vertices[p] - a)
        two = np.einsum("ij,ij->i", normal, vertices[q] - a)
        crossing = (one * two < 0) & ~np.isin(triangles, (p, q)).any(axis=1)
        t = (one / np.where(crossing, one - two, 1.0))[crossing]
        point = vertices[p] + t[:, None] * (vertices[q] - vertices[p])
        inside = np.ones(len(point), bool)
        for s, e in ((a, b), (b, c), (c, a)):
            side = np.cross((e - s)[crossing], point - s[crossing])
            inside &= np.einsum("ij,ij->i", side, normal[crossing]) > 1e-9 * np.einsum(
                "ij,ij->i", normal[crossing], normal[crossing]
            )
        found += int(inside.sum())
    return found


@given(SEEDS, st.sampled_from([0.1, 0.3, 0.7]), st.sampled_from(COSTS))
@examples(20)
def test_a_simplified_random_solid_contains_the_original(seed, fraction, cost):
    solid = random_solid(seed)
    mesh = arrays(solid)
    simplified = simplify_outwards(mesh, int(fraction * len(mesh[1])), cost=cost)
    assert_contains(solid, simplified)
    assert len(simplified.triangles) <= max(int(fraction * len(mesh[1])), 4) + 1 or simplified.reason


@pytest.mark.parametrize("cost", COSTS)
@pytest.mark.parametrize("name", PRINTABLE)
def test_a_simplified_printable_solid_contains_the_original(name, cost):
    solid = PRINTABLE[name]()
    mesh = arrays(solid)
    for fraction in (0.05, 0.3):
        assert_contains(solid, simplify_outwards(mesh, int(fraction * len(mesh[1])), cost=cost))


@given(SEEDS)
@examples(15)
def test_no_edge_pierces_a_triangle(seed):
    mesh = arrays(random_solid(seed))
    simplified = simplify_outwards(mesh, min(len(mesh[1]) // 4, 300))
    assert crossings(simplified.vertices, simplified.triangles) == 0


def test_opposite_walls_of_a_narrow_slot_do_not_pass_through_each_other():
    simplified = simplify_outwards(arrays(screw_plate()), 300)
    assert crossings(simplified.vertices, simplified.triangles) == 0


@pytest.mark.parametrize("limit", [0.05, 0.2])
@pytest.mark.parametrize("name", ["gear", "screw plate", "gyroid"])
def test_no_point_of_the_surface_is_farther_away_than_the_limit(name, limit):
    from trimesh.triangles import closest_point

    mesh = arrays(PRINTABLE[name]())
    simplified = simplify_outwards(mesh, 4, max_error=limit)
    assert len(simplified.triangles) < len(mesh[1])
    rng = np.random.default_rng(1)
    corners = simplified.vertices[simplified.triangles[rng.integers(len(simplified.triangles), size=150)]]
    points = np.einsum("ij,ijk->ik", rng.dirichlet((0.7, 0.7, 0.7), 150), corners)
    original = mesh[0][mesh[1]]
    for point in np.concatenate([points, simplified.vertices[:100]]):
        nearest = closest_point(original, np.broadcast_to(point, (len(original), 3)))
        assert np.linalg.norm(nearest - point, axis=1).min() <= limit + 1e-9


def test_a_looser_limit_leaves_fewer_triangles():
    mesh = arrays(Manifold.sphere(10, 48))
    counts = [len(simplify_outwards(mesh, 4, max_error=limit).triangles) for limit in (0.1, 0.2, 0.5)]
    assert counts[0] > counts[1] > counts[2]


def test_flat_faces_are_cleared_almost_without_growth():
    refined = Manifold.cube([10, 20, 30]).refine(8)
    simplified = simplify_outwards(arrays(refined), 12)
    assert len(simplified.triangles) == 12
    assert as_manifold(simplified.vertices, simplified.triangles).volume() == pytest.approx(6000.0, rel=1e-6)


def test_least_volume_adds_less_than_least_distance():
    mesh = arrays(screw_plate())
    grown = [
        as_manifold(*simplify_outwards(mesh, len(mesh[1]) // 5, cost=cost)[:2]).volume() for cost in COSTS
    ]
    assert grown[0] < grown[1]


def test_the_target_is_met_exactly_where_possible():
    mesh = arrays(Manifold.sphere(10, 64))
    for target in (4, 50, 1000):
        simplified = simplify_outwards(mesh, target)
        assert len(simplified.triangles) == target
        assert simplified.reason == ""


def test_a_missed_target_has_a_reason():
    two = Manifold.tetrahedron() + Manifold.tetrahedron().translate([5, 0, 0])
    simplified = simplify_outwards(arrays(two), 4)
    assert len(simplified.triangles) == 8
    assert simplified.reason == "no edge can be contracted"


def test_the_same_mesh_gives_the_same_result():
    mesh = arrays(gyroid())
    one, two = simplify_outwards(mesh, 300), simplify_outwards(mesh, 300)
    assert np.array_equal(one.vertices, two.vertices)
    assert np.array_equal(one.triangles, two.triangles)


def test_a_stopped_simplification_contains_the_original():
    solid = Manifold.sphere(10, 256)
    simplified = simplify_outwards(arrays(solid), 100, stop=lambda: True)
    assert simplified.reason == "stopped"
    assert 100 < len(simplified.triangles) < solid.num_tri()
    assert_contains(solid, simplified)


@pytest.mark.parametrize("shift", [[5, 5, 0], [5, 5, 5], [5, 0, 0]])
def test_shells_that_touch_in_an_edge_a_corner_or_a_face_stay_a_solid(shift):
    one = arrays(Manifold.cube([5, 5, 5]).refine(4))
    vertices = np.concatenate([one[0], one[0] + shift])
    triangles = np.concatenate([one[1], one[1] + len(one[0])])
    merged, number = np.unique(vertices, axis=0, return_inverse=True)
    simplified = simplify_outwards((merged, number[triangles]), 60)
    bounding = as_manifold(simplified.vertices, simplified.triangles)
    assert accepted(bounding)
    for corner in ([0, 0, 0], shift):
        assert (Manifold.cube([5, 5, 5]).translate(corner) - bounding).volume() == pytest.approx(
            0.0, abs=1e-9
        )


def test_needle_triangles_do_not_harm():
    rng = np.random.default_rng(3)
    vertices, triangles = arrays(Manifold.cylinder(20, 5, 5, 300))
    squeezed = vertices * [1.0, 1e-3, 1.0] + rng.uniform(-1e-7, 1e-7, vertices.shape)
    solid = as_manifold(squeezed, triangles)
    assert_contains(solid, simplify_outwards((squeezed, triangles), 100))
