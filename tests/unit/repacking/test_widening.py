"""Widened volumes contain what is beside a part in a build, and no more above or below it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold, OpType
from scipy.spatial.transform import Rotation
from tests.shared.examples import examples
from tests.shared.layouts import box, mesh_of

from amprep.geometry.meshes.manifold import as_manifold
from amprep.measures.bounding_volume import points_of
from amprep.model.bounding_volume import Boxes, ConvexPieces, Solid
from amprep.repacking.widening import widened

HOOK = box((12, 4, 3), (0, 0, 9)) + box((3, 4, 12), (0, 0, 0))
VOLUMES = {
    "boxes": Boxes([(0, 0, 9), (0, 0, 0)], [(12, 4, 12), (3, 4, 12)]),
    "convex": ConvexPieces((mesh_of(box((12, 4, 3), (0, 0, 9))), mesh_of(box((3, 4, 12), (0, 0, 0))))),
    "solid": Solid(mesh_of(HOOK)),
}
UPRIGHT = [np.eye(3), Rotation.from_euler("x", 90, degrees=True).as_matrix().round()]
ADD = OpType.Add
TURNED = [*UPRIGHT, Rotation.from_euler("zyx", [20, 50, 70], degrees=True).as_matrix()]


def solid_of(volume):
    if isinstance(volume, Boxes):
        pairs = zip(volume.lo.tolist(), volume.hi.tolist(), strict=True)
        return Manifold.batch_boolean([box(np.subtract(hi, lo), lo) for lo, hi in pairs], ADD)
    meshes = [volume.mesh] if isinstance(volume, Solid) else volume.pieces
    return Manifold.batch_boolean([as_manifold(*mesh.arrays) for mesh in meshes], ADD)


def turned(solid, rotation):
    return solid.transform(np.hstack([rotation, np.zeros((3, 1))]))


@pytest.mark.parametrize("kind", VOLUMES)
@pytest.mark.parametrize("rotation", TURNED, ids=["upright", "lying", "tilted"])
def test_a_volume_moved_sideways_by_the_distance_stays_in_the_widened_one(kind, rotation):
    wide = turned(solid_of(widened(VOLUMES[kind], rotation, 2.0)), rotation)
    for angle in np.radians(np.arange(0, 360, 30)):
        own = turned(solid_of(VOLUMES[kind]), rotation).translate(
            (1.95 * np.cos(angle), 1.95 * np.sin(angle), 0)
        )
        assert (own - wide).volume() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("kind", VOLUMES)
@pytest.mark.parametrize("rotation", UPRIGHT, ids=["upright", "lying"])
def test_a_widened_volume_is_as_high_as_before_and_wider_by_the_distance(kind, rotation):
    before, after = (
        points_of(volume) @ rotation.T for volume in (VOLUMES[kind], widened(VOLUMES[kind], rotation, 2.0))
    )
    assert after[:, 2].min() == pytest.approx(before[:, 2].min(), abs=1e-6)
    assert after[:, 2].max() == pytest.approx(before[:, 2].max(), abs=1e-6)
    for axis in (0, 1):
        assert np.ptp(after[:, axis]) == pytest.approx(np.ptp(before[:, axis]) + 4.0, abs=0.4)
        assert np.ptp(after[:, axis]) >= np.ptp(before[:, axis]) + 3.9


@given(seed=st.integers(0, 2**32), by=st.floats(0.1, 20.0))
@examples(20)
def test_a_widened_volume_contains_the_volume_in_any_orientation(seed, by):
    rotation = Rotation.random(rng=seed).as_matrix()
    for volume in VOLUMES.values():
        assert (solid_of(volume) - solid_of(widened(volume, rotation, by))).volume() == pytest.approx(
            0.0, abs=1e-6
        )
