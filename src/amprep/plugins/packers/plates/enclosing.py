"""A first layout of enclosing boxes, by `extreme-points`: in neat rows, and there in time."""

from dataclasses import replace

import numpy as np

from amprep.arrays import Floats
from amprep.model.control import Stop
from amprep.model.packing import Packing, PackingProblem
from amprep.model.part import Orientations
from amprep.plugins.packers.annealing.start import start_layout
from amprep.plugins.packers.plates.shapes import PlateInstance
from amprep.plugins.packers.plates.state import OnPlates


def box_layout(problem: PackingProblem, rng: np.random.Generator, stop: Stop) -> Packing:
    """Return a packing of the enclosing boxes; `height` becomes `fill`."""
    return start_layout(problem, "extreme-points", rng, stop)


def pack_enclosing(instance: PlateInstance, rng: np.random.Generator, stop: Stop) -> OnPlates:
    """Return a layout of the enclosing boxes of all items in their shapes, without those that are `alone`."""
    problem = instance.problem
    items = tuple(
        replace(item, orientations=Orientations("list", _rotations(instance, number)))
        for number, item in enumerate(problem.items)
    )
    packing = box_layout(replace(problem, items=items), rng, stop)
    rows = []
    for plate, build in enumerate(packing.builds):
        for placement in build:
            item = placement.item
            if not instance.free[item]:
                continue
            for shape in range(int(instance.first[item]), int(instance.end[item])):
                if np.array_equal(instance.shapes[shape].rotation, placement.rotation):
                    at = placement.translation[:2] - instance.shapes[shape].shift[:2]
                    rows.append((item, shape, plate, at))
                    break
    plates = {plate: number for number, plate in enumerate(sorted({row[2] for row in rows}))}
    if instance.problem.fixed:
        plates = {plate: plate for plate in plates}
    return OnPlates(
        np.array([row[0] for row in rows], np.int64),
        np.array([row[1] for row in rows], np.int64),
        np.array([plates[row[2]] for row in rows], np.int64),
        np.array([row[3] for row in rows], np.float64).reshape(-1, 2),
    )


def _rotations(instance: PlateInstance, item: int) -> Floats:
    shapes = instance.shapes[int(instance.first[item]) : int(instance.end[item])]
    return np.array([shape.rotation for shape in shapes] or [np.eye(3)])
