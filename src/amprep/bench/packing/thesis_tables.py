"""The two packing tables of the thesis (chapter 4) next to our results on generated instances of the same shape."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from amprep.bench.packing.run import PackerRun, PackingResult
from amprep.host import Host
from amprep.model import Boxes, BuildVolume, Item, Objective, PackingProblem
from amprep.testing.packing_instances import PackingInstance

BUILDS_BOXES = (15, 30, 45, 60, 75, 120)
FILL_BOXES = (20, 25, 30, 35)
SIDE = 100
COPIES = 3

THESIS_BUILDS: dict[str, tuple[str, ...]] = {
    "IP": ("0.06 s", "0.7 s", "2.76 s", "6.99 s", "33.1 s", "29 builds in 500 s"),
    "Tabu": ("0.04 s", "0.06 s", "0.08 s", "0.14 s, no proof", "3.7 s, no proof", "27 builds in 500 s"),
}
THESIS_FILL: dict[str, tuple[str, ...]] = {
    "IP": ("76%, 10 s", "80%, 30 s", "84%, 120 s", "83%, 120 s"),
    "local search, used 2, dir 30": ("76%, 11 s", "69%, 2.25 s", "83%, 94 s", "78%, 58 s"),
    "local search, used 5, dir 20": ("76%, 8 s", "79%, 76 s", "83%, 90 s", "81%, 90 s"),
    "local search, used 8, dir 10": ("76%, 5 s", "79%, 58 s", "83%, 61 s", "81%, 90 s"),
}


@dataclass(frozen=True)
class TableRow:
    """A packer with parameters, and its label in the table."""

    label: str
    packer: str
    params: dict[str, Any]


BUILDS_ROWS = tuple(
    TableRow(name, name, {}) for name in ("extreme-points", "tabu", "auto", "ip", "column-generation")
)
FILL_ROWS = (
    TableRow("extreme-points", "extreme-points", {}),
    TableRow("auto", "auto", {}),
    TableRow("ip", "ip", {}),
    TableRow("ip, no start", "ip", {"start": "none"}),
    *(
        TableRow(
            f"ip-local-search, used {used}, dir {direction}",
            "ip-local-search",
            {"used_distance": used, "direction_distance": direction, "start": "extreme-points"},
        )
        for used, direction in ((2, 30), (5, 20), (8, 10))
    ),
)


@dataclass(frozen=True)
class ThesisTable:
    """One table: the thesis's results and ours, one column per number of boxes."""

    title: str
    boxes: tuple[int, ...]
    thesis: dict[str, tuple[str, ...]]
    ours: dict[str, tuple[PackingResult, ...]]


def thesis_tables(
    packers: Sequence[str], max_boxes: int, *, seconds: float, seed: int, progress: Callable[[str], None]
) -> list[ThesisTable]:
    """Run the packers and return both tables.

    The thesis's own instances are not published. Ours have the same shape: several copies of each size, fixed
    orientations, and about five boxes per build.

    Parameters
    ----------
    packers
        Names of the packers; all that are available if empty.
    max_boxes
        Columns with more boxes are left out.
    seconds
        Time limit per instance.
    seed
        Seed of the packers' random numbers.
    progress
        Called with a line for each result.
    """
    host = Host.load()
    known = [name for name in host.offers("packer") if not packers or name in packers]
    for name in packers:
        host.choose("packer", name)

    def run(row: TableRow, n: int, objective: Objective) -> PackingResult:
        instance = repeated_boxes(n, objective)
        packer = PackerRun(host, host.choose("packer", row.packer), row.params, seconds, seed)
        packer.warm_up(instance.problem)
        result = packer.run(instance)
        progress(f"{row.label}: {result.line}")
        return result

    def table(
        title: str,
        boxes: tuple[int, ...],
        thesis: dict[str, tuple[str, ...]],
        rows: tuple[TableRow, ...],
        objective: Objective,
    ) -> ThesisTable:
        columns = tuple(n for n in boxes if n <= max_boxes)
        ours = {
            row.label: tuple(run(row, n, objective) for n in columns) for row in rows if row.packer in known
        }
        return ThesisTable(
            title, columns, {name: cells[: len(columns)] for name, cells in thesis.items()}, ours
        )

    return [
        table("fewest builds", BUILDS_BOXES, THESIS_BUILDS, BUILDS_ROWS, "builds"),
        table("greatest value in one build", FILL_BOXES, THESIS_FILL, FILL_ROWS, "fill"),
    ]


def repeated_boxes(n: int, objective: Objective) -> PackingInstance:
    """Return `n` boxes, three copies of each size, for cubes with sides of 100 mm; the seed is `n`.

    For `builds` the sides are 30 to 80 mm: 120 boxes need 24 builds, in the thesis 27. For `fill` they are 20
    to 55 mm, so that 20 boxes nearly fill one build.
    """
    rng = np.random.default_rng(n)
    least, most = (30, 80) if objective == "builds" else (20, 55)
    items: list[Item] = []
    while len(items) < n:
        size = rng.integers(least, most + 1, 3).astype(np.float64)
        part, volume = len(items) // COPIES, Boxes(np.zeros((1, 3)), size[None])
        copies = min(COPIES, n - len(items))
        items += [Item(part, copy, volume, float(size.prod())) for copy in range(copies)]
    cube = BuildVolume(np.full(3, float(SIDE)))
    return PackingInstance(f"{objective}_{n:03d}", PackingProblem(tuple(items), cube, objective))


def table_cell(result: PackingResult) -> str:
    """Return a result as the table shows it, with its processor time."""
    proof = ", proven" if result.status == "optimal" else ""
    proof += f"; by {result.found_by}" if result.found_by else ""
    if result.measure == "value":
        return f"{result.fill_ratio:.0%}, {result.processor_seconds:.2f} s{proof}"
    return f"{result.reached:g} builds (bound {result.bound or 0:g}), {result.processor_seconds:.2f} s{proof}"
