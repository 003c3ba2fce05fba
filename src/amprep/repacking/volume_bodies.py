"""The bounding volumes of a packing as rigid bodies."""

import numpy as np

from amprep.geometry.removal.bodies import CollisionShape, MovableBody, movable_body
from amprep.model import Boxes, PackingProblem, Placement
from amprep.model.volume_meshes import box_mesh, meshes_of

PARALLEL = 1e-9
"""Tolerance of an entry of a rotation by quarter turns."""


class VolumeBodies:
    """The bounding volumes of the items of a problem as bodies; items with one volume share their trees.

    Parameters
    ----------
    problem
        The items; its forbidden zones are bodies, too.
    """

    def __init__(self, problem: PackingProblem) -> None:
        self.problem = problem
        self._shapes: dict[int, tuple[CollisionShape, ...]] = {}
        pairs = zip(problem.space.zone_lo, problem.space.zone_hi, strict=True)
        boxes = [CollisionShape(*box_mesh(lo, hi).arrays) for lo, hi in pairs]
        self.zones = tuple(movable_body([(shape, np.eye(4))], is_boxes=True) for shape in boxes)

    def body(self, placement: Placement) -> MovableBody:
        """Return the volume of an item at its place."""
        volume, turned = self.problem.items[placement.item].volume, np.abs(placement.rotation)
        if id(volume) not in self._shapes:
            self._shapes[id(volume)] = tuple(CollisionShape(*mesh.arrays) for mesh in meshes_of(volume))
        is_boxes = isinstance(volume, Boxes) and bool(
            (np.minimum(turned, np.abs(1.0 - turned)) < PARALLEL).all()
        )
        return movable_body([(shape, placement.matrix) for shape in self._shapes[id(volume)]], is_boxes)

    def size(self, item: int) -> float:
        """Return the volume of the bounding box of an item, mm3."""
        body = self.body(Placement(item, np.eye(3), np.zeros(3)))
        return float(np.prod(body.high.max(axis=0) - body.low.min(axis=0)))
