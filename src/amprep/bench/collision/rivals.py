"""Collision queries by other packages on the same meshes: python-fcl, coal, manifold3d."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats
from amprep.bench.collision.engines import CollisionEngine
from amprep.bench.collision.scene import CollisionScene
from amprep.model import Mesh


class CollisionRival(NamedTuple):
    """Another package, and how to make its engine; it is given the scene and the margin."""

    package: str
    engine: Callable[[CollisionScene, float], CollisionEngine]


def _each(ask: Callable[[Floats], Any]) -> Callable[[Floats, Floats], NDArray[Any]]:
    """Return a function that asks pose by pose."""
    return lambda poses, _: np.array([ask(pose) for pose in poses])


def _fcl(scene: CollisionScene, margin: float) -> CollisionEngine:
    import fcl

    def model(mesh: Mesh) -> Any:
        made = fcl.BVHModel()
        made.beginModel(len(mesh.vertices), len(mesh.triangles))
        made.addSubModel(mesh.vertices, mesh.triangles)
        made.endModel()
        return made

    start = time.process_time()
    moving, other = model(scene.moving), fcl.CollisionObject(model(scene.other))
    took = time.process_time() - start

    def placed(pose: Floats) -> Any:
        return fcl.CollisionObject(moving, fcl.Transform(pose[:3, :3], pose[:3, 3]))

    def collide(pose: Floats) -> bool:
        return bool(fcl.collide(placed(pose), other, fcl.CollisionRequest(), fcl.CollisionResult()))

    def distance(pose: Floats) -> float:
        found = fcl.distance(placed(pose), other, fcl.DistanceRequest(), fcl.DistanceResult())
        return max(float(found), 0.0)

    queries = {"distance": _each(distance)} | ({} if margin else {"collide": _each(collide)})
    return CollisionEngine("python-fcl", True, took, 10**4, queries)  # type: ignore[arg-type]


def _coal(scene: CollisionScene, margin: float) -> CollisionEngine:
    import coal

    def model(mesh: Mesh) -> Any:
        made = coal.BVHModelOBBRSS()
        points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
        for point in mesh.vertices:
            points.append(point)
        for a, b, c in mesh.triangles.tolist():
            faces.append(coal.Triangle(a, b, c))
        made.beginModel(len(faces), len(points))
        made.addSubModel(points, faces)
        made.endModel()
        return made

    start = time.process_time()
    moving, other, here = model(scene.moving), model(scene.other), coal.Transform3s()
    took = time.process_time() - start

    def collide(pose: Floats) -> bool:
        request = coal.CollisionRequest()
        request.security_margin = margin
        at = coal.Transform3s(pose[:3, :3], pose[:3, 3])
        return bool(coal.collide(moving, at, other, here, request, coal.CollisionResult()))

    def distance(pose: Floats) -> float:
        at = coal.Transform3s(pose[:3, :3], pose[:3, 3])
        found = coal.distance(moving, at, other, here, coal.DistanceRequest(), coal.DistanceResult())
        return max(float(found), 0.0)

    queries = {"collide": _each(collide), "distance": _each(distance)}
    return CollisionEngine("coal", True, took, 10**4, queries)  # type: ignore[arg-type]


def _manifold(scene: CollisionScene, margin: float) -> CollisionEngine:
    from amprep.geometry.meshes.manifold import as_manifold

    start = time.process_time()
    moving, other = (as_manifold(*mesh.arrays) for mesh in (scene.moving, scene.other))
    took = time.process_time() - start

    def collide(pose: Floats) -> bool:
        placed = moving.transform(pose[:3])
        if margin > 0.0 and placed.min_gap(other, margin) < margin:
            return True
        return not (placed ^ other).is_empty()

    queries: dict[str, Callable[[Floats, Floats], Bools]] = {"collide": _each(collide)}
    return CollisionEngine("manifold3d", True, took, 20, queries)  # type: ignore[arg-type]


RIVALS = (
    CollisionRival("fcl", _fcl),
    CollisionRival("coal", _coal),
    CollisionRival("manifold3d", _manifold),
)
