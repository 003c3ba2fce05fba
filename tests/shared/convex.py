"""Random convex pieces and poses for tests of bounding volumes and of collisions."""

import numpy as np
from manifold3d import Manifold, OpType
from scipy.spatial.transform import Rotation

from amprep.geometry.bounding.convex.prepared import prepare_pieces


def random_sets(seed, most=4):
    """Return two sets of convex pieces, of which some are boxes, needles or plates."""
    rng = np.random.default_rng(seed)
    sets = []
    for _ in range(2):
        pieces = []
        for _ in range(int(rng.integers(1, most + 1))):
            points = rng.normal(size=(int(rng.integers(4, 20)), 3))
            if rng.random() < 0.4:
                points = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
            stretch = 10.0 ** rng.uniform(-1.5, 0.5, 3)
            pieces.append(points * stretch + rng.normal(size=3))
        sets.append(prepare_pieces(pieces))
    return sets


def random_poses(seed, count, spread=4.0):
    """Return rigid motions ``(count, 4, 4)``, of which every third turns by a multiple of a right angle."""
    rng = np.random.default_rng(seed)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = Rotation.random(count, random_state=rng).as_matrix()
    poses[::3, :3, :3] = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    poses[:, :3, 3] = rng.normal(size=(count, 3)) * spread
    return poses


def united(pieces, pose=None):
    """Return the union of a set of pieces at a pose as a solid of manifold3d."""
    pose = np.eye(4) if pose is None else pose
    hulls = [Manifold.hull_points(piece @ pose[:3, :3].T + pose[:3, 3]) for piece in pieces.pieces]
    return Manifold.batch_boolean(hulls, OpType.Add)


def moved(poses, shifts):
    """Return the poses, each shifted by a vector ``(n, 3)``."""
    shifted = poses.copy()
    shifted[:, :3, 3] += shifts
    return shifted
