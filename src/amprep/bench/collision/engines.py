"""Our engines for collision queries, and the record of an engine."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Floats
from amprep.bench.collision.scene import CollisionScene, tree_of
from amprep.geometry.trees.queries import directional_distances, surface_distances, surfaces_collide
from amprep.model import Mesh

Query = Literal["collide", "distance", "directional"]
Ask = Callable[[Floats, Floats], NDArray[Any]]
"""Answers ``(n,)`` for poses ``(n, 4, 4)`` and directions ``(n, 3)``."""


@dataclass(frozen=True)
class CollisionEngine:
    """A way to answer queries about the two parts of a scene.

    Attributes
    ----------
    on_meshes
        Whether the answers are about the meshes; else about bounding volumes, which collide more often.
    build_seconds
        Processor time of what is prepared once for both parts.
    most_poses
        Number of poses up to which it takes seconds.
    queries
        What it can answer.
    """

    name: str
    on_meshes: bool
    build_seconds: float
    most_poses: int
    queries: Mapping[Query, Ask]


def obb_trees(scene: CollisionScene, margin: float) -> CollisionEngine:
    """Return the engine of OBB trees (thesis 2.6)."""
    tree_of(scene.other)
    start = time.process_time()
    a, b = tree_of(scene.moving), tree_of(scene.other)
    took = time.process_time() - start
    here = np.eye(4)
    return CollisionEngine(
        "OBB trees",
        True,
        took,
        10**9,
        {
            "collide": lambda poses, _: surfaces_collide(a, b, poses, here, margin),
            "distance": lambda poses, _: surface_distances(a, b, poses, here),
            "directional": lambda poses, along: directional_distances(a, b, poses, here, along, margin),
        },
    )


def convex_pieces(scene: CollisionScene, margin: float) -> list[CollisionEngine]:
    """Return the engines of convex pieces: by GJK, and by linear programs (thesis 2.5)."""
    from amprep.geometry.bounding.convex.collision import pieces_collide, pieces_distance, pieces_travel
    from amprep.geometry.bounding.convex.prepared import prepare_pieces

    start = time.process_time()
    a, b = (prepare_pieces(_pieces(mesh)) for mesh in (scene.moving, scene.other))
    took = time.process_time() - start
    here = np.eye(4)
    by_gjk: dict[Query, Ask] = {
        "collide": lambda poses, _: pieces_collide(a, b, poses, here, margin),
        "distance": lambda poses, _: pieces_distance(a, b, poses, here),
        "directional": lambda poses, along: pieces_travel(a, b, poses, here, along, margin),
    }
    by_program: dict[Query, Ask] = {
        "collide": lambda poses, _: pieces_collide(a, b, poses, here, margin, "lp")
    }
    pieces = f"{len(a.first) - 1} and {len(b.first) - 1} convex pieces"
    return [
        CollisionEngine(f"{pieces}, GJK", False, took, 10**9, by_gjk),
        CollisionEngine(f"{pieces}, LP", False, took, 20, by_program),
    ]


def _pieces(mesh: Mesh) -> list[Floats]:
    """Return the vertices of the convex pieces that the volume maker makes with its usual parameters."""
    from amprep.geometry.bounding.convex.decompose import PieceGoal, decompose_by_cuts
    from amprep.geometry.meshes.manifold import as_manifold
    from amprep.plugins.volumes.params import ConvexPiecesParams

    usual = ConvexPiecesParams()
    goal = PieceGoal(usual.pieces, usual.excess, usual.concavity_mm)
    return decompose_by_cuts(as_manifold(*mesh.arrays), goal, lambda: False)
