"""The thesis's two packing tables (chapter 4) beside ours, on generated instances of the same shape."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from amprep.bench.packing.instances import Instance
from amprep.bench.packing.run import Result, run_one
from amprep.host import Host
from amprep.model import Boxes, BuildVolume, Item, Objective, PackingProblem

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
class Row:
    """One packer under one choice of parameters; its label in the table."""

    label: str
    packer: str
    params: dict[str, Any]


BUILDS_ROWS = tuple(
    Row(name, name, {}) for name in ("extreme-points", "tabu", "auto", "ip", "column-generation")
)
FILL_ROWS = (
    Row("extreme-points", "extreme-points", {}),
    Row("auto", "auto", {}),
    Row("ip", "ip", {}),
    *(
        Row(
            f"ip-local-search, used {used}, dir {direction}",
            "ip-local-search",
            {"used_distance": used, "direction_distance": direction},
        )
        for used, direction in ((2, 30), (5, 20), (8, 10))
    ),
)


@dataclass(frozen=True)
class Table:
    """One of the tables: what the thesis found and what is found here, column by column of boxes."""

    title: str
    boxes: tuple[int, ...]
    thesis: dict[str, tuple[str, ...]]
    ours: dict[str, tuple[Result, ...]]


_Asked = tuple[str, tuple[int, ...], dict[str, tuple[str, ...]], tuple[Row, ...], Objective]


def thesis_tables(
    packers: Sequence[str], most_boxes: int, *, seconds: float, seed: int, progress: Callable[[str], None]
) -> list[Table]:
    """Run the packers on offer (of `packers`, all when empty) and return both tables.

    The thesis's own instances are not published. Ours are of its shape: several copies of each size, box by
    box in the orientation given, some five boxes a build.
    """
    host = Host.load()
    known = [name for name in host.offers("packer") if not packers or name in packers]
    for name in packers:
        host.choose("packer", name)
    asked: tuple[_Asked, ...] = (
        ("fewest builds", BUILDS_BOXES, THESIS_BUILDS, BUILDS_ROWS, "builds"),
        ("greatest filling of one build", FILL_BOXES, THESIS_FILL, FILL_ROWS, "fill"),
    )
    tables = []
    for title, boxes, thesis, rows, objective in asked:
        columns = tuple(n for n in boxes if n <= most_boxes)
        ours: dict[str, tuple[Result, ...]] = {}
        for row in rows:
            if row.packer in known:
                found = []
                for n in columns:
                    instance = repeated_boxes(n, objective)
                    found.append(run_one(host, row.packer, instance, row.params, seconds=seconds, seed=seed))
                    progress(f"{row.label}: {found[-1].line}")
                ours[row.label] = tuple(found)
        tables.append(
            Table(title, columns, {name: cells[: len(columns)] for name, cells in thesis.items()}, ours)
        )
    return tables


def repeated_boxes(n: int, objective: Objective) -> Instance:
    """Return `n` boxes, three copies of each size, for cubes of side 100; the seed is `n`.

    For `builds` sides are 30 to 80: 120 boxes need 24 builds, in the thesis 27. For `fill` they are 20 to 55,
    so that 20 boxes nearly fill one build.
    """
    rng = np.random.default_rng(n)
    least, most = (30, 80) if objective == "builds" else (20, 55)
    items: list[Item] = []
    while len(items) < n:
        size = rng.integers(least, most + 1, 3).astype(np.float64)
        part, volume = len(items) // COPIES, Boxes(np.zeros((1, 3)), size[None])
        copies = min(COPIES, n - len(items))
        items += [Item(part, copy, volume, float(size.prod())) for copy in range(copies)]
    room = BuildVolume(np.full(3, float(SIDE)))
    return Instance(f"{objective}_{n:03d}", PackingProblem(tuple(items), room, objective))


def cell(result: Result) -> str:
    """Return a result as the table shows it."""
    proof = ", proven" if result.status == "optimal" else ""
    if result.measure == "value":
        return f"{result.share:.0%}, {result.seconds:.2f} s{proof}"
    return f"{result.reached:g} builds (bound {result.bound or 0:g}), {result.seconds:.2f} s{proof}"
