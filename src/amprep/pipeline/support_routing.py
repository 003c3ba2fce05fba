"""Routes the red squares of a build: as one network, or part by part so that supports are not shared."""

from typing import NamedTuple

import numpy as np

from amprep.model.arrays import Ints
from amprep.model.control import Report, Stop, silent
from amprep.pipeline.support_edges import (
    cubes_below,
    cubes_used,
    keys_of,
    no_cubes,
    no_edges,
    part_of_edges,
)
from amprep.pipeline.support_network import Network
from amprep.pipeline.support_sharing import share


class Routed(NamedTuple):
    """Where the supports run.

    Attributes
    ----------
    edges
        ``(n, 7)`` int32: plane, y, x, direction, flow, capacity, part; edges of several plans may repeat.
    reasons
        For each red square; ``""`` when it is connected.
    """

    edges: Ints
    reasons: tuple[str, ...]


def route_together(network: Network, report: Report) -> Routed:
    """Route everything as one network, as in the thesis: supports of different parts may merge."""
    reds = np.flatnonzero(network.red.square[:, 0] > 0).astype(np.int32)
    edges = network.connect(reds, no_cubes(), network.stop, report)
    edges[:, 6] = part_of_edges(edges, network.red, reds)
    return Routed(edges, tuple(network.reasons))


def route_apart(network: Network, report: Report) -> Routed:
    """Route part by part; squares and cubes in use are closed to the parts that follow.

    Parts come by the height of their highest red square, lowest first: the less height, the less room to
    give way. Cubes right below the red squares of other parts are kept free for these. Each part gets an equal
    share of the time that is left. Red squares that stay unconnected are then routed once more with the cubes
    of other supports open: they share where they must.
    """
    red = network.red
    above = red.square[:, 0] > 0
    parts = sorted(
        set(red.part[above].tolist()), key=lambda part: (int(red.square[red.part == part, 0].max()), part)
    )
    blocks = [no_edges()]
    for done, part in enumerate(parts):
        own = np.flatnonzero(above & (red.part == part)).astype(np.int32)
        kept = cubes_below(red.square[above & (red.part != part)])
        kept = kept[~np.isin(keys_of(kept), keys_of(cubes_below(red.square[own])))]
        closed = np.concatenate([kept, *(cubes_used(block) for block in blocks)])
        edges = network.connect(own, closed, _equal_share(network.stop, len(parts) - done), silent)
        edges[:, 6] = part
        blocks.append(edges)
        report((done + 1) / (len(parts) + 1), "routing part by part")
    edges = share(network, np.concatenate(blocks))
    return Routed(edges, tuple(network.reasons))


def _equal_share(stop: Stop, count: int) -> Stop:
    """Return a stop that leaves as much time for each of `count - 1` others, when there is a limit."""
    return stop if stop.deadline is None else stop.within(stop.remaining() / count)
