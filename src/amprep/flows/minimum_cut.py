"""Sends on what still finds a way in a flow that is there: few units, beyond a jam or after capacities grew."""

from functools import cached_property

import numpy as np

from amprep.arrays import Bools, Bytes, Int32s, Int64s
from amprep.kernels.flow.minimum_cut import extend
from amprep.kernels.flow.residual import Carried, Room
from amprep.kernels.flow.shortest_paths import Network


class Extender:
    """Extends a flow in place, search by search; its work arrays serve them all.

    Attributes
    ----------
    ground
        ``(stride,)`` how many more paths may end at each square of the plate.
    """

    def __init__(self, network: Network, carried: Carried, ground: Int32s) -> None:
        self.network, self.carried, self.ground = network, carried, ground

    @cached_property
    def _work(self) -> tuple[Bytes, Int32s, Bytes, Int32s]:
        states = 2 * self.network.via.size
        stack, reached = np.empty(states, np.int32), np.empty(states, np.int32)
        return np.zeros(states, np.uint8), stack, np.empty(states, np.uint8), reached

    @property
    def marks(self) -> Bytes:
        """A work array over all states, to be left at 0."""
        return self._work[0]

    def extend(self, room: Room, starts: Int64s) -> tuple[Bools, Int32s]:
        """Send units from squares ``(n,)``; return which were served, and what can be reached when none was."""
        served = np.zeros(starts.size, np.uint8)
        count = extend(self.network, self.carried, room, self.ground, starts, served, *self._work)
        done: Bools = served == 1
        return done, self._work[-1][: 0 if done.any() else count]
