"""The longest straight edges of layers are those that brute force finds in sections of the mesh."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from tests.shared.examples import examples
from tests.shared.solids import mesh_of

from amprep.geometry.slicing.planar_faces import find_planar_faces
from amprep.geometry.slicing.straight_traces import straight_traces


def traces_of(solid, least=10.0, rotation=None):
    mesh = mesh_of(solid)
    return straight_traces(find_planar_faces(mesh.vertices, mesh.triangles), least, rotation)


def by_angle(traces):
    return sorted(zip(np.round(traces.angle_deg, 3) % 180.0, np.round(traces.length, 2), strict=True))


def test_a_box_has_four_traces_of_its_sides():
    found = traces_of(Manifold.cube([30, 20, 5]))
    assert by_angle(found) == [(0, 30), (0, 30), (90, 20), (90, 20)]
    assert (found.low.tolist(), found.high.tolist()) == ([0] * 4, [5] * 4)
    assert by_angle(traces_of(Manifold.cube([30, 20, 5]), 25)) == [(0, 30), (0, 30)]
    assert len(traces_of(Manifold.cube([9, 9, 50])).length) == 0


def test_a_turned_box_has_turned_traces():
    turn = trimesh.transformations.rotation_matrix(np.radians(20), [0, 0, 1])[:3, :3]
    assert by_angle(traces_of(Manifold.cube([30, 20, 5]), rotation=turn)) == [
        (20, 30), (20, 30), (110, 20), (110, 20)
    ]  # fmt: skip


def test_a_lying_cylinder_meets_the_blade_along_its_axis():
    found = traces_of(Manifold.cylinder(40, 10, 10, 64).rotate([90, 0, 0]))
    along = np.abs(found.angle_deg - 90.0) < 1e-3
    assert along.sum() > 50
    assert found.length[along] == pytest.approx(40)
    assert found.length[~along] == pytest.approx([20, 20], abs=0.1), "the flat ends"
    assert len(traces_of(Manifold.cylinder(40, 10, 10, 64)).length) == 0, (
        "a standing one has short edges only"
    )


def test_a_face_with_a_slot_has_traces_of_its_widest_layer():
    comb = Manifold.cube([30, 5, 20]) - Manifold.cube([10, 9, 12]).translate([10, -1, 8])
    found = traces_of(comb)
    long = found.angle_deg < 1
    assert sorted(np.round(found.length[long], 2)) == [30, 30]
    assert (found.middle[long, 2] < 8).all()
    assert traces_of(comb.trim_by_plane([0, 0, 1], 9), 9).length.max() == pytest.approx(10)


@given(seed=st.integers(0, 10**6))
@examples(25)
def test_traces_of_random_prisms_are_those_of_dense_sections(seed):
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(4, 9)))
    outline = np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(12, 25, (len(angles), 1))
    solid = Manifold.extrude(CrossSection([outline]), 20.0, scale_top=(0.6, 0.6))
    solid = (solid - Manifold.cube([9, 60, 6]).translate([-4, -30, 7])).rotate(
        [float(rng.uniform(0, 30)), 0, 0]
    )
    mesh, found = mesh_of(solid), traces_of(solid, 8.0)
    section = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    lengths: dict[float, float] = {}
    for z in np.linspace(mesh.bounds[0][2] + 1e-3, mesh.bounds[1][2] - 1e-3, 120):
        for angle, length in edges_of(section, z):
            lengths[angle] = max(lengths.get(angle, 0.0), length)
    for angle, length in lengths.items():
        if length > 8.2:
            near = np.abs((found.angle_deg - angle + 90) % 180 - 90) < 0.3
            assert near.any(), (angle, length)
            assert found.length[near].max() >= length - 0.05


def edges_of(mesh, z):
    """Direction (degrees, rounded) and length of the straight edges of a section."""
    path = mesh.section(plane_origin=[0, 0, z], plane_normal=[0, 0, 1])
    for loop in path.discrete if path is not None else ():
        corners = loop[:-1, :2]
        step = np.roll(corners, -1, axis=0) - corners
        keep = np.linalg.norm(step, axis=1) > 1e-6
        corners, step = corners[keep], step[keep]
        unit = step / np.linalg.norm(step, axis=1, keepdims=True)
        bends = np.abs(
            unit[:, 0] * np.roll(unit, 1, axis=0)[:, 1] - unit[:, 1] * np.roll(unit, 1, axis=0)[:, 0]
        )
        corners = corners[bends > 2e-3]
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            yield (
                round(float(np.degrees(np.arctan2(*(b - a)[::-1]))) % 180.0, 1),
                float(np.linalg.norm(b - a)),
            )


def test_traces_lie_on_the_surface():
    solid = Manifold.cube([30, 20, 15], True).rotate([0, 20, 33])
    mesh, found = mesh_of(solid), traces_of(solid)
    surface = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    assert len(found.length) >= 4
    assert trimesh.proximity.closest_point_naive(surface, found.middle)[1].max() < 1e-3
