"""Ways out for powder that supports lock in: the shortest straight ones from each pocket to the outside."""

from collections.abc import Iterator, Sequence

import numpy as np

from amprep.geometry.powder import Arrays, Floats, Ints, Runs, Void, flood, free_runs_of

MOST_DRAINS = 200
"""Ways that are sought in one support at most, for the largest pockets."""

_RUNS = 8
"""Of a pocket, the longest, from which ways are sought."""

_FARTHEST = 3.0
"""mm sideways."""


def find_drains(support: Arrays, parts: Sequence[Arrays], hole: float) -> list[tuple[Floats, Floats]]:
    """Return boxes (least and greatest corner, mm) which, cut out of a support, let powder out.

    Each leads from a pocket straight down, or straight aside along an axis, to where a ball of diameter `hole`
    gets out; through supports alone, not through parts. It is twice as wide as the hole. Pockets without such
    a way are left.
    """
    void = flood([support, *parts], hole)
    if not void.pocket.any():
        return []
    around = free_runs_of(void.lines, parts) if parts else None
    found = []
    for runs in _by_pocket(void):
        ways = [way for run in runs for way in _ways(void, around, run)]
        if ways:
            start, end = min(ways, key=lambda way: float(np.abs(way[1] - way[0]).sum()))
            beyond = np.where(np.abs(end - start) < 1e-9, hole, hole / 2.0)
            found.append((np.minimum(start, end) - beyond, np.maximum(start, end) + beyond))
    return found


def _by_pocket(void: Void) -> Iterator[Ints]:
    """Yield the longest runs of each pocket, the pockets with the longest ones first."""
    length = void.roomy.high - void.roomy.low
    chosen = np.flatnonzero(void.pocket)
    chosen = chosen[np.argsort(-length[chosen], kind="stable")]
    number, first = np.unique(void.pocket[chosen], return_index=True)
    for each in number[np.argsort(first)][:MOST_DRAINS]:
        yield chosen[void.pocket[chosen] == each][:_RUNS]


def _ways(void: Void, around: Runs | None, run: int) -> Iterator[tuple[Floats, Floats]]:
    """Yield straight ways from a run of a pocket to the outside, as their two ends."""
    lines, roomy = void.lines, void.roomy
    ny, nx = lines.shape
    line = int(np.searchsorted(roomy.start, run, side="right")) - 1
    low = float(roomy.low[run])
    middle = (low + float(roomy.high[run])) / 2.0

    def place(at: int, z: float) -> Floats:
        plan = lines.origin + (np.array([at % nx, at // nx]) + 0.5) * lines.spacing
        return np.array([*plan, z])

    def in_part(at: int, z: float) -> bool:
        return around is not None and around.at(at, z) < 0

    below = run - 1
    if below >= roomy.start[line] and void.pocket[below] == 0:
        end = float(roomy.high[below])
        if around is None or around.at(line, low) == around.at(line, end):
            yield place(line, low), place(line, end)
    for step_y, step_x in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        y, x = divmod(line, nx)
        for _ in range(int(_FARTHEST / lines.spacing)):
            y, x = y + step_y, x + step_x
            if not (0 <= y < ny and 0 <= x < nx) or in_part(y * nx + x, middle):
                break
            other = roomy.at(y * nx + x, middle)
            if other >= 0 and void.pocket[other] == 0:
                yield place(line, middle), place(y * nx + x, middle)
                break
