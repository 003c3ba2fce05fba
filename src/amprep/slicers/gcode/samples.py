"""Collect the lines of the recorded layers, within a limit of memory."""

from collections import defaultdict

import numpy as np

from amprep.arrays import Float32s, Floats, Int64s
from amprep.checks.gcode.found import SlicedLayer

MOST_LINES_OF_A_LAYER = 20_000
MOST_LINES_OF_ALL = 2_000_000
"""Lines beyond these numbers are left out; 2 million lines take 40 MB."""

LENGTH_OF_A_LAYER = 300_000.0
"""Length (mm) of lines beyond which those of a layer are left out: judges lay a point on every 0.3 mm of them."""


class LayerSamples:
    """The recorded layers of each row of the tracks."""

    def __init__(self) -> None:
        self._pieces: dict[tuple[int, float], list[Float32s]] = defaultdict(list)
        self._heights: dict[int, list[float]] = defaultdict(list)
        self._thickness: dict[tuple[int, float], float] = {}
        self._counts: dict[tuple[int, float], int] = defaultdict(int)
        self._lengths: dict[tuple[int, float], float] = defaultdict(float)
        self._dropped: set[tuple[int, float]] = set()
        self._total = 0

    def add(self, segments: Floats) -> None:
        """Add lines ``(n, COLUMNS)`` in the order of the file."""
        if not len(segments):
            return
        changes = np.flatnonzero((np.diff(segments[:, :2], axis=0) != 0.0).any(axis=1)) + 1
        bounds: Int64s = np.concatenate([[0], changes, [len(segments)]])
        for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
            self._add_run(segments[first:last])

    def _add_run(self, run: Floats) -> None:
        """Add lines of one row and one layer."""
        key = (int(run[0, 0]), float(run[0, 1]))
        room = min(MOST_LINES_OF_A_LAYER - self._counts[key], MOST_LINES_OF_ALL - self._total)
        if key not in self._thickness:
            self._heights[key[0]].append(key[1])
        self._thickness[key] = float(run[0, 2])
        lengths = self._lengths[key] + np.cumsum(np.hypot(run[:, 5] - run[:, 3], run[:, 6] - run[:, 4]))
        room = min(room, int(np.searchsorted(lengths, LENGTH_OF_A_LAYER, side="right")))
        if len(run) > room:
            self._dropped.add(key)
        if room <= 0 and key in self._pieces:
            return
        kept = run[: max(room, 0), 3:].astype(np.float32)
        self._pieces[key].append(kept)
        self._counts[key] += len(kept)
        self._lengths[key] = float(lengths[room - 1]) if room > 0 else self._lengths[key]
        self._total += len(kept)

    def of_row(self, row: int) -> tuple[SlicedLayer, ...]:
        """Return the recorded layers of a row, in ascending order."""
        keys = [(row, z) for z in sorted(self._heights.get(row, []))]
        return tuple(
            SlicedLayer(
                key[1], self._thickness[key], np.concatenate(self._pieces[key]), key not in self._dropped
            )
            for key in keys
        )
