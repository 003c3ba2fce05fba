"""Named packing problems: the published instances of Martello, Pisinger and Vigo."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from amprep.model import Boxes, BuildVolume, Item, PackingProblem

MPV_SIDE = {1: 100, 2: 100, 3: 100, 4: 100, 5: 100, 6: 10, 7: 40, 8: 100}
"""Side of the bin in each class of Martello, Pisinger and Vigo."""


class PackingInstance(NamedTuple):
    """A packing problem with a name."""

    name: str
    problem: PackingProblem


def mpv_instance(class_: int, n: int, index: int) -> PackingInstance:
    """Return a published instance, made by the authors' generator.

    Martello, Pisinger, Vigo, Operations Research 48 (2000), doi:10.1287/opre.48.2.256.12386. Boxes keep
    their orientation, may be stacked and need no clearance.

    Parameters
    ----------
    class_
        Class of the instance, 1 to 8.
    n
        Number of boxes; the published instances have 50, 100, 150 or 200.
    index
        Number of the instance in its class, from 1.
    """
    sizes = list(_mpv_sizes(class_, n, index))
    return PackingInstance(f"mpv_{class_}_{n:03d}_{index:02d}", _builds_problem(sizes, MPV_SIDE[class_]))


def _mpv_sizes(class_: int, n: int, index: int) -> Iterator[list[int]]:
    """Yield the sides of the boxes; the random numbers are those of ``lrand48`` seeded with ``index + n``."""
    state, side = ((index + n) << 16) + 0x330E, MPV_SIDE[class_]

    def draw(first: int, last: int) -> int:
        nonlocal state
        state = (0x5DEECE66D * state + 0xB) % 2**48
        return first + (state >> 17) % (last - first + 1)

    short, long = (1, side // 2), (2 * side // 3, side)
    ranges = {1: (short, long, long), 2: (long, short, long), 3: (long, long, short), 5: (short,) * 3}
    ranges |= {4: ((side // 2, side),) * 3, 6: ((1, 10),) * 3, 7: ((1, 35),) * 3, 8: ((1, 100),) * 3}
    for _ in range(n):
        box_class = draw(1, 10) if class_ <= 5 else class_
        yield [draw(*interval) for interval in ranges[box_class if box_class <= 5 else class_]]


def _builds_problem(sizes: Sequence[Sequence[float]], side: float) -> PackingProblem:
    """Return the problem of packing boxes ``(n, 3)`` of fixed orientation into as few cubes as possible."""
    items = (
        Item(i, 0, Boxes(np.zeros((1, 3)), np.array([size], float)), float(np.prod(size)))
        for i, size in enumerate(sizes)
    )
    return PackingProblem(tuple(items), BuildVolume(np.full(3, float(side))), "builds")
