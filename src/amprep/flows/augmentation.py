"""Augment a flow by a few units: beyond congestion, or after capacities have grown."""

from functools import cached_property

import numpy as np

from amprep.arrays import Bools, Bytes, Int32s, Int64s
from amprep.kernels.flow.augmentation import DepthFirstArrays, augment_depth_first
from amprep.kernels.flow.records import Capacities, Flow, FlowNetwork, ResidualNetwork


class Augmentation:
    """Augments a flow in place, search by search; all searches share its work arrays.

    Attributes
    ----------
    plate_capacity
        ``(stride,)`` number of further paths that may end at each square of the plate.
    """

    def __init__(self, network: FlowNetwork, flow: Flow, plate_capacity: Int32s) -> None:
        self.network, self.flow, self.plate_capacity = network, flow, plate_capacity

    @cached_property
    def _work(self) -> DepthFirstArrays:
        states = 2 * self.network.passable.size
        return DepthFirstArrays(
            seen=np.zeros(states, np.uint8),
            stack=np.empty(states, np.int32),
            arcs=np.empty(states, np.uint8),
            reached=np.empty(states, np.int32),
        )

    @property
    def marks(self) -> Bytes:
        """``(states,)`` a work array, 0 between searches; leave it so."""
        return self._work.seen

    def augment(self, capacities: Capacities, starts: Int64s) -> tuple[Bools, Int32s]:
        """Send a unit from each square of `starts` ``(n,)``, where a search finds a path.

        Returns
        -------
        (n,) bool, (k,) int32
            The starts that were served; if none was, the states that they can reach, else nothing.
        """
        served = np.zeros(starts.size, np.uint8)
        residual = ResidualNetwork(self.network, self.flow, capacities)
        count = augment_depth_first(residual, self.plate_capacity, starts, served, self._work)
        done: Bools = served == 1
        return done, self._work.reached[: 0 if done.any() else count]
