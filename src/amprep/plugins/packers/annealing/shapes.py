"""The bounding volumes of a problem as shapes of a collision engine."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from amprep.arrays import Floats, frozen
from amprep.errors import AmprepError
from amprep.model.bounding_volume import BoundingVolume, Boxes, ConvexPieces, Solid
from amprep.model.mesh import Mesh, join_meshes
from amprep.model.packing import PackingProblem

if TYPE_CHECKING:
    from amprep.kernels.annealing.box_shapes import BoxShapes
    from amprep.kernels.annealing.piece_shapes import PieceShapes
    from amprep.kernels.annealing.tree_shapes import TreeShapes

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=bool)

_FACES = np.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    + [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
)


def choose_engine(problem: PackingProblem, wanted: str) -> str:
    """Return the collision engine: ``boxes``, ``trees`` or ``pieces``.

    Raises
    ------
    AmprepError
        If the wanted engine cannot handle the volumes or the orientations.
    """
    boxes = _stay_boxes(problem)
    pieces = not any(not isinstance(item.volume, Boxes | ConvexPieces) for item in problem.items)
    if wanted == "any":
        return "boxes" if boxes else "pieces" if pieces else "trees"
    if (wanted == "boxes" and not boxes) or (wanted == "pieces" and not pieces):
        needs = {"boxes": "boxes that stay parallel to the axes", "pieces": "boxes or convex pieces"}[wanted]
        raise AmprepError(
            f"packer 'annealing': collision = {wanted!r} needs {needs} as bounding volumes; choose 'any'"
        )
    return wanted


def _stay_boxes(problem: PackingProblem) -> bool:
    """Return whether all volumes are boxes that stay parallel to the axes."""
    for item in problem.items:
        turns = item.orientations.matrices
        if not isinstance(item.volume, Boxes) or item.orientations.freedom != "list" or not _is_axis(turns):
            return False
    return all(_is_axis(placement.rotation) for placement in problem.fixed)


def _is_axis(turns: Floats) -> bool:
    return bool((np.minimum(np.abs(turns), np.abs(1.0 - np.abs(turns))) <= 1e-9).all())


def points_of(volume: BoundingVolume) -> Floats:
    """Return points ``(n, 3)`` whose convex hull is that of the volume, mm."""
    if isinstance(volume, Boxes):
        return _extreme(np.where(_CORNERS[None], volume.hi[:, None], volume.lo[:, None]).reshape(-1, 3))
    if isinstance(volume, ConvexPieces):
        return _extreme(np.concatenate([piece.vertices for piece in volume.pieces]))
    return _extreme(volume.mesh.vertices[np.unique(volume.mesh.triangles)])


def _extreme(points: Floats) -> Floats:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except (QhullError, ValueError):
        return points


def make_shapes(volumes: Sequence[BoundingVolume], engine: str, *, turning: bool = True) -> Any:
    """Return the volumes as the shapes of an engine; `turning` tells whether any may be turned by any angle."""
    if engine == "trees":
        return tree_shapes(volumes, turning=turning)
    return box_shapes(volumes) if engine == "boxes" else piece_shapes(volumes)


def box_shapes(volumes: Sequence[BoundingVolume]) -> "BoxShapes":
    """Return volumes that are all boxes as shapes."""
    from amprep.kernels.annealing.box_shapes import BoxShapes

    boxes = [volume for volume in volumes if isinstance(volume, Boxes)]
    lo, hi = np.concatenate([b.lo for b in boxes]), np.concatenate([b.hi for b in boxes])
    first = np.cumsum([0] + [len(b.lo) for b in boxes])
    return BoxShapes((lo + hi) / 2.0, (hi - lo) / 2.0, first)


def tree_shapes(volumes: Sequence[BoundingVolume], *, turning: bool = True) -> "TreeShapes":
    """Return any volumes as meshes with OBB trees; the meshes of boxes and pieces may overlap in one shape."""
    from amprep.geometry.trees.collision_mesh import collision_mesh
    from amprep.geometry.trees.stacks import new_stack
    from amprep.kernels.annealing.tree_shapes import ListedTreeShapes, TreeShapes

    trees = [collision_mesh(*mesh_of(volume).arrays).tree for volume in volumes]
    columns = [(t.nodes, t.link, t.cones, t.corners, t.normals, t.order, t.samples, t.hull) for t in trees]
    nodes, link, cones, corners, normals, order, samples, hull = (
        frozen(np.concatenate(arrays), arrays[0].dtype) for arrays in zip(*columns, strict=True)
    )
    sizes = [(len(t.nodes), len(t.corners), len(t.samples), len(t.hull)) for t in trees]
    starts = np.concatenate((np.zeros((1, 4), np.int64), np.cumsum(sizes, axis=0)))
    depth = [t.depth for t in trees]
    first = frozen(np.column_stack((starts, [*depth, 0])), np.int64)
    stack = new_stack(max(depth), max(depth))
    kind = TreeShapes if turning else ListedTreeShapes
    return kind(nodes, link, cones, corners, normals, order, samples, hull, first, stack)


def mesh_of(volume: BoundingVolume) -> Mesh:
    """Return the surface of a volume; that of each box or piece where there are several."""
    if isinstance(volume, Solid):
        return volume.mesh
    if isinstance(volume, ConvexPieces):
        return join_meshes(volume.pieces)
    boxes = zip(volume.lo, volume.hi, strict=True)
    return join_meshes([Mesh(np.where(_CORNERS, hi, lo), _FACES) for lo, hi in boxes])


def piece_shapes(volumes: Sequence[BoundingVolume]) -> "PieceShapes":
    """Return boxes and convex pieces as sets of convex pieces."""
    from amprep.geometry.bounding.convex.prepared import prepare_pieces
    from amprep.kernels.annealing.piece_shapes import PieceShapes
    from amprep.kernels.bounding.piece_sets import COLUMNS, SIMPLEX_ROWS

    sets = [prepare_pieces(hulls_of(volume)).arrays for volume in volumes]
    points = np.cumsum([0] + [len(s.vertices) for s in sets])
    rows = np.cumsum([0] + [len(s.centre) for s in sets])
    return PieceShapes(
        vertices=frozen(np.concatenate([s.vertices for s in sets]), np.float64),
        first=frozen(np.concatenate([s.first + p for s, p in zip(sets, points, strict=False)]), np.int64),
        centre=frozen(np.concatenate([s.centre for s in sets]), np.float64),
        half=frozen(np.concatenate([s.half for s in sets]), np.float64),
        row=frozen(rows, np.int64),
        frame=np.zeros((3, 4)),
        ray=np.zeros(3),
        work=np.empty((int(np.diff(rows).max()) + 1 + SIMPLEX_ROWS, COLUMNS)),
    )


def hulls_of(volume: BoundingVolume) -> list[Floats]:
    """Return points of each box or convex piece, whose hull it is."""
    if isinstance(volume, Boxes):
        return list(np.where(_CORNERS[None], volume.hi[:, None], volume.lo[:, None]))
    return [piece.vertices for piece in volume.pieces] if isinstance(volume, ConvexPieces) else []
