"""One annealing of one build: the state, the rules, and the loop that asks when to stop."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.model.control import Stop
from amprep.model.packing import Placement
from amprep.plugins.packers.annealing.params import SCHEDULES, AnnealingParams
from amprep.plugins.packers.annealing.scene import PreparedVolumes, make_scene, place

if TYPE_CHECKING:
    from amprep.kernels.annealing.records import AnnealingRules, AnnealingState

PAUSE = 0.005
"""Seconds of moves between two calls of `stop`."""


@dataclass(frozen=True, eq=False)
class BuildTask:
    """One build to be annealed.

    Attributes
    ----------
    movable
        Items that may move.
    fixed
        Placements that stay.
    layout
        First placements by item; the other movable items begin beside the build volume.
    weights, volumes
        ``(movable,)`` energy of each item outside the build volume, and its volume in mm3.
    lowers
        Whether the layout is to become low.
    least_height
        Height (mm) that no layout can have less of.
    """

    movable: Sequence[int]
    fixed: Sequence[Placement]
    layout: Mapping[int, Placement]
    weights: Floats
    volumes: Floats
    lowers: bool
    least_height: float = 0.0


class BuildSearch:
    """Anneals the layout of one build; items that are not in the build are beside it.

    Attributes
    ----------
    movable
        Items that may move.
    colliding
        Number of pairs of bodies that were closer than their clearance in the first layout.
    """

    def __init__(
        self,
        prepared: PreparedVolumes,
        task: BuildTask,
        params: AnnealingParams,
        rng: np.random.Generator,
    ) -> None:
        from amprep.kernels.annealing.loop import begin, count_collisions

        self.movable = list(task.movable)
        weights, volumes = task.weights, task.volumes
        mean = float(weights.mean()) if weights.size and weights.mean() > 0.0 else 1.0
        masses = params.gravity * volumes / max(float(volumes.mean()), 1e-12) if volumes.size else volumes
        self.weights = np.maximum(weights / mean, 1e-9)
        self.scene, poses = make_scene(prepared, self.movable, task.fixed, self.weights, masses)
        place(poses, self.movable, task.layout)
        self.shapes = prepared.shapes
        self.rules = _rules(params, len(self.movable), self.scene.high - self.scene.low, lowers=task.lowers)
        self.state = _state(poses, len(self.movable), float(self.scene.high[2]), rng)
        begin(self.scene, self.state, self.rules)
        self.colliding = int(count_collisions(self.shapes, self.scene, self.state))
        self.total = params.moves * len(self.movable)
        self.least_height = task.least_height

    def run(self, stop: Stop, progress: Callable[[float, str], None]) -> str:
        """Make moves until the budget is used up, or until told to stop; return the reason of a stop or ""."""
        from amprep.kernels.annealing.loop import anneal

        left, count = self.total, 1
        while left > 0:
            if stop():
                return stop.reason
            if self.is_solved:
                return ""
            progress(1.0 - left / self.total, self.summary)
            count, begun = min(count, left), time.perf_counter()
            anneal(self.shapes, self.scene, self.state, self.rules, count)
            left -= count
            count = _next_count(count, time.perf_counter() - begun)
        return ""

    @property
    def inside(self) -> Bools:
        """Which movable items are in the build in the best layout, ``(movable,)``."""
        return self.state.best_inside

    @property
    def is_solved(self) -> bool:
        """Whether all items are in the build, and as low as is proved possible where height counts."""
        lowest = self.rules.shrink == 0.0 or float(self.state.figures[2]) <= self.least_height + 1e-3
        return bool(self.inside.all()) and lowest

    @property
    def summary(self) -> str:
        """Summary of the best layout for the progress."""
        placed = f"{int(self.inside.sum())} of {len(self.movable)} items"
        top = float(self.state.figures[2])
        return f"{placed}, {top:.1f} mm high" if self.rules.shrink > 0.0 and np.isfinite(top) else placed

    def best(self) -> tuple[Placement, ...]:
        """Return the placements of the best layout, without the fixed ones."""
        return tuple(
            Placement(item, pose.reshape(3, 4)[:, :3], pose.reshape(3, 4)[:, 3])
            for item, pose, kept in zip(self.movable, self.state.best_pose, self.inside.tolist(), strict=True)
            if kept
        )


def _next_count(count: int, seconds: float) -> int:
    """Return the number of moves that take about `PAUSE`; it changes the pauses, not the moves."""
    return int(np.clip(count * PAUSE / max(seconds, 1e-6), 1, 2 * count + 1))


def _rules(params: AnnealingParams, count: int, size: Floats, *, lowers: bool) -> "AnnealingRules":
    from amprep.kernels.annealing.records import AnnealingRules

    return AnnealingRules(
        schedule=SCHEDULES.index(params.schedule),
        hot=params.temperature,
        cold=params.last_temperature,
        cycle=max(1, params.cycle * count),
        reach=params.max_travel * float(np.max(size)),
        angle=float(np.radians(params.max_angle_deg)),
        drops=params.drops,
        turns=params.turns,
        sinks=params.sinks,
        shrink=params.shrink if lowers else 0.0,
    )


def _state(poses: Floats, movable: int, ceiling: float, rng: np.random.Generator) -> "AnnealingState":
    from amprep.kernels.annealing.records import CEILING, AnnealingState

    bodies, figures = len(poses), np.zeros(5)
    figures[CEILING] = ceiling
    return AnnealingState(
        pose=poses,
        box=np.zeros((bodies, 6)),
        inside=np.zeros(movable, np.bool_),
        best_pose=poses[:movable].copy(),
        best_inside=np.zeros(movable, np.bool_),
        trial=np.zeros(12),
        trial_box=np.zeros(6),
        near=np.zeros(bodies, np.int64),
        entry=np.zeros(bodies),
        figures=figures,
        counts=np.zeros(4, np.int64),
        random=rng.integers(1, 2**63, 1, dtype=np.uint64),
    )
