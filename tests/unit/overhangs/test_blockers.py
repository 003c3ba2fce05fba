"""Blockers and enforcers mark what lies in them, to the millimetre, not whole triangles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.shared.builds import box_mesh
from tests.shared.examples import examples
from tests.shared.optional import present

from amprep.geometry.meshes.subdivision import subdivide
from amprep.model import Mesh, Part, PlacedPart, Region
from amprep.model.supports.rules import SupportRules
from amprep.overhangs.blockers import FINEST, apply_regions
from amprep.overhangs.of_part import overhangs_of

SLAB = box_mesh((0, 0, 10), (100, 60, 5))
"""Its underside is two triangles."""


def underside(mesh):
    corners = mesh.vertices[mesh.triangles]
    return np.flatnonzero((corners[:, :, 2] < 10.001).all(axis=1))


def area(mesh, chosen):
    corners = mesh.vertices[mesh.triangles[chosen]]
    return (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2
    )


def edge_uses(mesh):
    ends = np.sort(np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2), axis=2).reshape(
        -1, 2
    )
    return np.unique(ends, axis=0, return_counts=True)[1]


def blocked_area(*regions, mesh=SLAB, matrix=None):
    marked = apply_regions(mesh, regions, np.eye(4) if matrix is None else matrix)
    assert (edge_uses(marked.mesh) == 2).all(), "no gaps, no corners on edges"
    assert marked.mesh.signed_volume == pytest.approx(mesh.signed_volume)
    under = underside(marked.mesh)
    return area(marked.mesh, under[present(marked.modifiers).blocked[under]])


@given(x=st.floats(5, 60), y=st.floats(5, 30), size=st.floats(3, 25))
@examples(15)
def test_a_blocker_box_blocks_its_own_area_of_a_large_triangle(x, y, size):
    found = blocked_area(Region("blocker", "b", mesh=box_mesh((x, y, 9), (size, size, 2))))
    assert found == pytest.approx(size * size, abs=4 * size * FINEST)


def test_regions_move_with_the_part():
    turn = np.array([[0.0, -1, 0, 90], [1, 0, 0, 5], [0, 0, 1, 0], [0, 0, 0, 1]])
    blocker = Region("blocker", "b", mesh=box_mesh((10, 10, 9), (20, 20, 2)))
    assert blocked_area(blocker, mesh=SLAB.moved(turn), matrix=turn) == pytest.approx(400, abs=80 * FINEST)


def test_without_blockers_and_enforcers_the_mesh_stays_as_it_is():
    marked = apply_regions(SLAB, (Region("lattice", "l", mesh=box_mesh((0, 0, 0), (5, 5, 5))),), np.eye(4))
    assert marked.mesh is SLAB
    assert marked.modifiers is None


def test_needs_lose_what_is_blocked_and_gain_what_is_enforced():
    slope = Mesh(SLAB.vertices + (0, 0, 1) * (SLAB.vertices[:, [0]] * 2.0), SLAB.triangles)  # 63 degrees
    enforcer = Region("enforcer", "e", mesh=box_mesh((20, 10, 0), (10, 10, 300)))
    rules = SupportRules()
    bare = overhangs_of(PlacedPart("s", Part("s", slope, 1.0), np.eye(4)), rules)
    assert [region.kind for region in bare.overhangs.regions] == ["edge"], "only its lower edge"
    forced = overhangs_of(PlacedPart("s", Part("s", slope, 1.0, regions=(enforcer,)), np.eye(4)), rules)
    (face,) = (region for region in forced.overhangs.regions if region.kind == "face")
    assert face.measure == pytest.approx(100 * np.sqrt(5), rel=0.15)
    blocker = Region("blocker", "b", mesh=box_mesh((-1, -1, 9), (51, 62, 2)))
    rest = overhangs_of(PlacedPart("s", Part("s", SLAB, 1.0, regions=(blocker,)), np.eye(4)), rules)
    (face,) = rest.overhangs.regions
    assert face.measure == pytest.approx(3000, abs=120 * FINEST)
    assert face.centre[0] == pytest.approx(75, abs=1)


def test_refining_ends_where_nothing_is_wanted_and_names_the_parents():
    fine = subdivide(
        SLAB.vertices, SLAB.triangles, lambda corners, parent: (parent == 3) & (_size(corners) > 10)
    )
    assert _size(fine.vertices[fine.triangles[fine.parent == 3]]).max() <= 10
    for parent in range(12):
        here = Mesh(fine.vertices, fine.triangles)
        assert area(here, fine.parent == parent) == pytest.approx(area(SLAB, [parent]))


def _size(corners):
    return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
