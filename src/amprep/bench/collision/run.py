"""Time collision queries of several engines on the same poses, and count where their answers agree."""

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats
from amprep.bench.collision.engines import CollisionEngine, Query, convex_pieces, obb_trees
from amprep.bench.collision.rivals import RIVALS
from amprep.bench.collision.scene import CollisionScene
from amprep.geometry.meshes.distance import triangle_distance

_JUDGED = 10
"""Number of poses at which the judge of packings measures the distance as well."""

_NEAR = 1e-6
"""mm; answers may differ where the distance is this close to the margin, and distances by this much."""


@dataclass(frozen=True)
class CollisionResult:
    """One query of one engine, in figures.

    Attributes
    ----------
    engine, query
        Names; the query is `collide`, `distance` or `directional`.
    poses
        Number of poses that were asked.
    microseconds
        Processor time of a query in the mean; None if the engine did not run.
    per_second
        Queries a second of processor time.
    positive
        For `collide`: number of poses in collision; for `directional`: number of poses at which the way is blocked.
    agree
        Number of poses at which the answer equals that of the OBB trees; of the trees, that of the judge at the first
        poses. Bounding volumes agree if they are no less careful.
    of
        Number of poses that were compared.
    build_ms
        Processor time for what is prepared once for both parts, ms.
    validated
        False if an answer is wrong; None if it was not compared.
    note
        Why an engine did not run.
    """

    engine: str
    query: str
    poses: int = 0
    microseconds: float | None = None
    per_second: float | None = None
    positive: int | None = None
    agree: int | None = None
    of: int | None = None
    build_ms: float | None = None
    validated: bool | None = None
    note: str = ""

    @property
    def record(self) -> dict[str, Any]:
        """The result for JSON."""
        return asdict(self)

    @property
    def line(self) -> str:
        """The result on one line."""
        if self.microseconds is None:
            return f"{self.engine}: {self.note}"
        text = f"{self.engine}: {self.query} {self.microseconds:.1f} us, {self.per_second:,.0f} a second"
        if self.positive is not None:
            text += (
                f", {self.positive} of {self.poses} {'blocked' if self.query == 'directional' else 'collide'}"
            )
        if self.of:
            text += f", {self.agree} of {self.of} agree"
        return text + f" (built in {self.build_ms:.0f} ms)"


def run_collision(
    scene: CollisionScene, *, margin: float = 0.0, pieces: bool = True, rivals: bool = True
) -> Iterator[CollisionResult]:
    """Time every engine on the poses of a scene.

    Parameters
    ----------
    scene
        Two parts in near contact.
    margin
        Clearance, mm.
    pieces, rivals
        Whether convex pieces, and other packages that are installed, answer as well.
    """
    trees = obb_trees(scene, margin)
    answers = {query: trees.queries[query](scene.poses, scene.directions) for query in trees.queries}
    for query in trees.queries:
        yield _timed(trees, query, scene, answers, margin)
    for engine in convex_pieces(scene, margin) if pieces else ():
        for query in engine.queries:
            yield _timed(engine, query, scene, answers, margin)
    for rival in RIVALS if rivals else ():
        if find_spec(rival.package) is None:
            yield CollisionResult(rival.package, "", note="not run: the package is not installed")
            continue
        engine = rival.engine(scene, margin)
        for query in engine.queries:
            yield _timed(engine, query, scene, answers, margin)


def _timed(
    engine: CollisionEngine,
    query: Query,
    scene: CollisionScene,
    known: dict[Query, NDArray[Any]],
    margin: float,
) -> CollisionResult:
    count = min(len(scene.poses), engine.most_poses)
    poses, along = scene.poses[:count], scene.directions[:count]
    ask = engine.queries[query]
    ask(poses[:1], along[:1])
    start = time.process_time()
    found = ask(poses, along)
    took = max(time.process_time() - start, 1e-9)
    if engine.name == "OBB trees":
        same = _judged(scene, found, query, margin)
    else:
        same = _equal(engine, query, found, {name: each[:count] for name, each in known.items()}, margin)
    positive = {"collide": found, "distance": None, "directional": np.isfinite(found)}[query]
    return CollisionResult(
        engine.name,
        query,
        count,
        1e6 * took / count,
        count / took,
        None if positive is None else int(np.sum(positive)),
        int(same.sum()) if len(same) else None,
        len(same) or None,
        1e3 * engine.build_seconds,
        bool(same.all()) if len(same) else None,
    )


def _judged(scene: CollisionScene, found: NDArray[Any], query: Query, margin: float) -> Bools:
    """Tell where the answers of the trees equal the judge of packings, at the first poses."""
    if query == "directional":
        return np.empty(0, np.bool_)
    other = scene.other.vertices[scene.other.triangles]
    same = []
    for pose, answer in zip(scene.poses[:_JUDGED], found, strict=False):
        placed = scene.moving.moved(pose)
        least = triangle_distance(placed.vertices[placed.triangles], other, max(5.0, margin + 1.0))
        if query == "collide":
            same.append(bool(answer) == (least < margin) or abs(least - margin) <= _NEAR)
        else:
            same.append(abs(max(least, 0.0) - answer) <= _NEAR)
    return np.array(same, np.bool_)


def _equal(
    engine: CollisionEngine,
    query: Query,
    found: NDArray[Any],
    known: dict[Query, NDArray[Any]],
    margin: float,
) -> Bools:
    """Tell where answers equal those of the trees; bounding volumes may be more careful."""
    expected = known[query]
    if query == "collide":
        if not engine.on_meshes:
            return np.asarray(found >= expected)
        apart: Floats = known["distance"]
        touching = np.abs(apart - margin) <= _NEAR if margin > 0.0 else ~expected & (apart <= _NEAR)
        return np.asarray((found == expected) | touching)
    if not engine.on_meshes:
        return np.asarray(found <= expected + _NEAR)
    return np.asarray((found == expected) | (np.abs(found - expected) <= _NEAR))
