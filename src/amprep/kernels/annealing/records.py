"""Records that the kernels of the annealing share: the scene, its state, and the rules of the moves."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.arrays import Bools, Floats, Int64s

LISTED, ABOUT_Z, FREE = 0, 1, 2
"""Values of `AnnealingScene.freedom`."""

GEOMETRIC, LINEAR, ADAPTIVE = 0, 1, 2
"""Values of `AnnealingRules.schedule`."""

DONE, ACCEPTED, IMPROVED, STALE = 0, 1, 2, 3
"""Entries of `AnnealingState.counts`: moves, accepted ones, improvements, moves since the last improvement."""

OUTSIDE, BEST_OUTSIDE, BEST_TOP, CEILING, TEMPERATURE = 0, 1, 2, 3, 4
"""Entries of `AnnealingState.figures`: weight outside now and in the best layout, mm, mm, temperature."""

TOUCH = 1e-7
"""mm; bodies that enter one another, or a wall, by at most this much only touch."""

SKIN = 1e-5
"""mm; a body that is moved until it touches stops this much earlier."""

Vector = tuple[float, float, float]


class AnnealingScene(NamedTuple):
    """Bodies and the build volume; bodies are the movable items, then fixed items, then forbidden zones.

    Attributes
    ----------
    shape_of
        ``(m,)`` int64 shape of each body; copies of a part share one.
    points
        ``(h, 3)`` vertices of the convex hulls of all shapes, shape by shape, mm.
    first_point
        ``(shapes + 1,)`` index of the first vertex of each shape.
    weight
        ``(m,)`` energy of a body outside the build volume; the mean of the movable ones is 1. 0 for the others.
    mass
        ``(m,)`` x by the height of the build volume.
    margin
        ``(m,)`` mm; two bodies keep the smaller one of their margins.
    freedom
        ``(m,)`` LISTED, ABOUT_Z or FREE.
    first_turn
        ``(m + 1,)`` index of the first rotation of each body in `turns`.
    turns
        ``(k, 9)`` rotations that re-insertion tries.
    berth
        ``(movable, 12)`` pose of each movable body outside the build volume, apart from all others.
    low, high
        ``(3,)`` corners of the region for bodies in the build volume, mm.
    radius
        Radius of a cylindrical build volume less the clearance, mm; 0 for a box.
    hall_low, hall_high
        ``(3,)`` corners of the box that bodies never leave, mm.
    is_flat
        Whether all bodies are at the lowest height (no stacking).
    """

    shape_of: Int64s
    points: Floats
    first_point: Int64s
    weight: Floats
    mass: Floats
    margin: Floats
    freedom: Int64s
    first_turn: Int64s
    turns: Floats
    berth: Floats
    low: Floats
    high: Floats
    radius: float
    hall_low: Floats
    hall_high: Floats
    is_flat: bool


class AnnealingState(NamedTuple):
    """Poses of the bodies, the best ones so far, and work arrays; all are modified.

    Attributes
    ----------
    pose
        ``(m, 12)`` rows of the ``(3, 4)`` matrix of each body.
    box
        ``(m, 6)`` corners of its axis-parallel box, mm.
    inside
        ``(m,)`` bool: movable bodies in the build volume.
    best_pose, best_inside
        ``(movable, 12)`` and ``(movable,)``, of the best layout.
    trial
        ``(12,)`` and ``trial_box`` ``(6,)``, pose and box of a move that is not yet accepted.
    near, entry
        ``(m,)`` bodies near a path and the travel at which their boxes are met, mm.
    figures, counts
        See `CEILING` and `DONE`.
    random
        ``(1,)`` uint64 state of the random numbers, not 0.
    """

    pose: Floats
    box: Floats
    inside: Bools
    best_pose: Floats
    best_inside: Bools
    trial: Floats
    trial_box: Floats
    near: Int64s
    entry: Floats
    figures: Floats
    counts: Int64s
    random: NDArray[np.uint64]


class AnnealingRules(NamedTuple):
    """Parameters of the moves and of the temperature.

    Attributes
    ----------
    schedule
        GEOMETRIC, LINEAR or ADAPTIVE.
    hot, cold
        First and last temperature, in units of the mean weight.
    cycle
        Moves from the first temperature to the last one; then the best layout is annealed again. With ADAPTIVE, the
        moves without an improvement after which the temperature rises again.
    reach
        Greatest travel of a move, mm (the thesis's mmd).
    angle
        Greatest angle of a move, rad.
    drops, turns, sinks
        Probabilities of a re-insertion, of a rotation, and of a move downwards as far as possible.
    shrink
        Fraction of the height by which the ceiling is lowered below the best layout; 0 leaves the ceiling.
    """

    schedule: int
    hot: float
    cold: float
    cycle: int
    reach: float
    angle: float
    drops: float
    turns: float
    sinks: float
    shrink: float


Shapes = Any
"""`BoxShapes`, `TreeShapes` or `PieceShapes`."""
