"""Find the red squares from which a path leads to the plate."""

from amprep.arrays import Bools
from amprep.flows.network import build_network, distances_of
from amprep.kernels.flow.records import UNREACHABLE
from amprep.model.supports import SupportProblem


def find_reachable(problem: SupportProblem) -> Bools:
    """Return for each red square ``(m,)`` whether it is reachable: whether its distance to the plate is finite."""
    network, start = build_network(problem)
    return distances_of(network, start, (1, 1))[start] < UNREACHABLE
