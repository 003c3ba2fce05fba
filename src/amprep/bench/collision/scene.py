"""Two parts in near contact, for the benchmark of collision queries."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from amprep.arrays import Floats
from amprep.geometry.trees.collision_mesh import CollisionMesh, collision_mesh
from amprep.geometry.trees.queries import directional_distances
from amprep.model import Mesh


@dataclass(frozen=True, eq=False)
class CollisionScene:
    """A part at many poses beside another one at rest.

    Attributes
    ----------
    names
        Of the moving part and of the other one.
    moving, other
        The parts, about the origin.
    poses
        ``(n, 4, 4)`` rigid motions of the moving part.
    directions
        ``(n, 3)`` unit vectors for the directional distances.
    """

    names: tuple[str, str]
    moving: Mesh
    other: Mesh
    poses: Floats
    directions: Floats


def made_parts(triangles: int) -> dict[str, Mesh]:
    """Return a bracket with holes and a ribbed tube of at most so many triangles each, or of the fewest possible."""
    from manifold3d import Manifold

    bracket = Manifold.cube((40, 24, 5)) + Manifold.cube((5, 24, 30))
    for x, y in ((14, 6), (14, 18), (32, 6), (32, 18)):
        bracket -= Manifold.cylinder(9, 2.2, 2.2, 48).translate((x, y, -2))
    bracket -= Manifold.cylinder(9, 6, 6, 64).rotate((0, 90, 0)).translate((-2, 12, 18))
    tube = Manifold.cylinder(36, 11, 11, 96)
    for height in (4, 12, 20, 28):
        tube += Manifold.cylinder(2, 14, 14, 96).translate((0, 0, height))
    tube -= Manifold.cylinder(40, 8, 8, 96).translate((0, 0, -2))
    solids = {"bracket": bracket, "tube": tube.rotate((20, 30, 0))}
    meshes = {}
    for name, solid in solids.items():
        length = 1.5 * np.sqrt(solid.surface_area() / triangles)
        while (fine := solid.refine_to_length(float(length))).num_tri() > triangles and length < 100.0:
            length *= 1.05
        mesh = fine.to_mesh64()
        meshes[name] = Mesh(np.asarray(mesh.vert_properties)[:, :3], mesh.tri_verts)
    return meshes


def near_contact(
    parts: Mapping[str, Mesh], count: int, *, margin: float, spread: float, seed: int
) -> CollisionScene:
    """Place the first of two parts at random poses close to the surface of the second.

    The part has a uniform random rotation, travels along a random direction until its distance to the other is the
    margin, and then moves back or forth by at most `spread`, both in mm.
    """
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(seed)
    names = list(parts)
    first, second = names[0], names[-1]
    moving, other = (_centred(parts[name]) for name in (first, second))
    reach = sum(float(np.linalg.norm(mesh.vertices, axis=1).max()) for mesh in (moving, other)) + 1.0 + margin
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = Rotation.from_quat(rng.normal(size=(count, 4))).as_matrix()
    inwards = _unit(rng, count)
    poses[:, :3, 3] = -reach * inwards
    trees, here = (tree_of(moving), tree_of(other)), np.eye(4)
    travel = directional_distances(*trees, poses, here, inwards, margin, limit=reach)
    poses[:, :3, 3] += (travel + rng.uniform(-spread, spread, count))[:, None] * inwards
    return CollisionScene((first, second), moving, other, poses, _unit(rng, count))


def tree_of(mesh: Mesh) -> CollisionMesh:
    """Return the collision mesh of a mesh."""
    return collision_mesh(*mesh.arrays)


def _centred(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices - np.mean(mesh.bounds, axis=0), mesh.triangles)


def _unit(rng: np.random.Generator, count: int) -> Floats:
    vectors = rng.normal(size=(count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
