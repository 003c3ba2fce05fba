"""The thesis's table of support planning (chapter 4): nodes, edges and seconds of three routers on inputs A to E."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from amprep.bench.routing.run import THESIS_SECONDS, RoutingResult, run_router
from amprep.host import Host
from amprep.testing.support_scenes import count_graph
from amprep.testing.thesis_inputs import thesis_input

ROUTERS = tuple(THESIS_SECONDS)
"""The routers of the table, in its order."""

NODES = {"A": 8196, "B": 27670, "C": 62708, "D": 1110380, "E": 6424582}
EDGES = {"A": 35674, "B": 126566, "C": 296235, "D": 5348590, "E": 31381816}
"""Numbers of nodes and edges of the thesis's inputs."""


@dataclass(frozen=True)
class InputResults:
    """One column of the table: an input, and the results of the routers in the order of the rows."""

    name: str
    nodes: int
    edges: int
    red_squares: int
    results: tuple[RoutingResult, ...]


def thesis_table(
    inputs: Sequence[str],
    routers: Sequence[str],
    *,
    capacity: int,
    seed: int,
    progress: Callable[[str], None],
) -> list[InputResults]:
    """Run the routers on the inputs and return the columns of the table.

    Each router first runs on the inputs A and C, which compiles it with and without room for all paths. Then it runs
    once on every input and is measured.

    Parameters
    ----------
    inputs
        Letters of the inputs.
    routers
        Names of the routers.
    capacity
        Largest number of paths through a square; 0 for no limit. The thesis does not state its own.
    seed
        Seed of the routers' random numbers.
    progress
        Called with a line for each result.

    Raises
    ------
    PluginError
        If a router is unknown or fails.
    """
    host = Host.load()
    chosen = [host.choose("router", router) for router in routers]
    blank = RoutingResult("", "input", "A", capacity, 0, 0, 0, None)
    for listed in chosen:
        for small in "AC":
            run_router(host, listed, thesis_input(small, capacity=capacity), seed, blank, warm=True)
    columns = []
    for name in inputs:
        problem = thesis_input(name, capacity=capacity)
        nodes, edges = count_graph(problem)
        own = replace(blank, size=name, nodes=nodes, edges=edges, red_squares=len(problem.red))
        results = []
        for listed in chosen:
            results.append(run_router(host, listed, problem, seed, own, warm=True))
            progress(results[-1].line)
        columns.append(InputResults(name, nodes, edges, len(problem.red), tuple(results)))
    return columns
