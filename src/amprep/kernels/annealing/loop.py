"""The main loop of the annealing (thesis 2.6): bodies move at random, never intersect, and are drawn into the build."""

import numpy as np

from amprep.kernels.annealing.moves import reinsert, rotate, translate
from amprep.kernels.annealing.paths import collisions
from amprep.kernels.annealing.records import (
    ACCEPTED,
    ADAPTIVE,
    BEST_OUTSIDE,
    BEST_TOP,
    CEILING,
    DONE,
    IMPROVED,
    LINEAR,
    OUTSIDE,
    STALE,
    TEMPERATURE,
    AnnealingRules,
    AnnealingScene,
    AnnealingState,
    Shapes,
)
from amprep.kernels.annealing.space import classify, enclose, is_inside, layout_top
from amprep.kernels.helper import kernel, uncounted
from amprep.kernels.random_numbers import uniform

SAME = 1e-9
"""Difference of weights and heights that counts as none."""


@uncounted
def _restore_best(scene: AnnealingScene, state: AnnealingState) -> None:
    """Put all movable bodies where they are in the best layout."""
    for body in range(state.inside.size):
        for k in range(12):
            state.pose[body, k] = state.best_pose[body, k]
        enclose(scene, body, state.pose[body], state.box[body])
    state.figures[OUTSIDE] = classify(scene, state)


@uncounted
def _cool(scene: AnnealingScene, state: AnnealingState, rules: AnnealingRules) -> float:
    """Return the temperature of the next move; at the end of a cycle, start another one from the best layout."""
    done, stale = state.counts[DONE], state.counts[STALE]
    if rules.schedule == ADAPTIVE:
        if done == 0 or stale >= rules.cycle:
            state.figures[TEMPERATURE] = rules.hot
            state.counts[STALE] = 0
            if done > 0:
                _restore_best(scene, state)
        else:
            factor = (rules.cold / rules.hot) ** (1.0 / rules.cycle)
            state.figures[TEMPERATURE] = max(rules.cold, state.figures[TEMPERATURE] * factor)
        return state.figures[TEMPERATURE]
    if done % rules.cycle == 0 and done > 0:
        _restore_best(scene, state)
    fraction = (done % rules.cycle) / rules.cycle
    if rules.schedule == LINEAR:
        state.figures[TEMPERATURE] = rules.hot + fraction * (rules.cold - rules.hot)
    else:
        state.figures[TEMPERATURE] = rules.hot * (rules.cold / rules.hot) ** fraction
    return state.figures[TEMPERATURE]


@uncounted
def _pick(state: AnnealingState) -> int:
    """Return a random movable body: in half of the cases one outside, if there is any."""
    movable, outside = state.inside.size, 0
    for body in range(movable):
        outside += not state.inside[body]
    if outside == 0 or uniform(state.random) < 0.5:
        return int(uniform(state.random) * movable)
    number = int(uniform(state.random) * outside)
    for body in range(movable):
        if not state.inside[body]:
            if number == 0:
                return body
            number -= 1
    return 0


@uncounted
def _remember(scene: AnnealingScene, state: AnnealingState, rules: AnnealingRules) -> None:
    """Keep the layout if it is better than the best one; then lower the ceiling below it where height counts."""
    figures, counts = state.figures, state.counts
    if figures[OUTSIDE] > figures[BEST_OUTSIDE] + SAME:
        return
    top = layout_top(scene, state) if rules.shrink > 0.0 else 0.0
    if figures[OUTSIDE] > figures[BEST_OUTSIDE] - SAME and top >= figures[BEST_TOP] - SAME:
        return
    figures[BEST_OUTSIDE], figures[BEST_TOP] = figures[OUTSIDE], top
    for body in range(state.inside.size):
        state.best_inside[body] = state.inside[body]
        for k in range(12):
            state.best_pose[body, k] = state.pose[body, k]
    counts[IMPROVED] += 1
    counts[STALE] = 0
    if rules.shrink > 0.0 and figures[OUTSIDE] <= SAME:
        figures[CEILING] = top - max(rules.shrink * (top - scene.low[2]), 1e-3)
        figures[OUTSIDE] = classify(scene, state)


@uncounted
def _commit(scene: AnnealingScene, state: AnnealingState, body: int) -> None:
    """Make the trial pose the pose of a body."""
    for k in range(12):
        state.pose[body, k] = state.trial[k]
    for k in range(6):
        state.box[body, k] = state.trial_box[k]
    was = state.inside[body]
    state.inside[body] = is_inside(scene, state.figures[CEILING], body, state.pose[body], state.box[body])
    if was != state.inside[body]:
        state.figures[OUTSIDE] += scene.weight[body] if was else -scene.weight[body]
    state.counts[ACCEPTED] += 1


@kernel
def begin(scene: AnnealingScene, state: AnnealingState, rules: AnnealingRules) -> None:
    """Prepare the state of given poses: boxes, bodies inside, the best layout.

    Parameters
    ----------
    scene, rules
        Constant data and parameters.
    state
        With `pose`, `random` and the ceiling set; the rest is written.
    """
    for body in range(scene.shape_of.size):
        enclose(scene, body, state.pose[body], state.box[body])
    state.counts[:] = 0
    state.figures[OUTSIDE] = classify(scene, state)
    state.figures[BEST_OUTSIDE], state.figures[BEST_TOP] = np.inf, np.inf
    _remember(scene, state, rules)


@kernel
def anneal(
    shapes: Shapes, scene: AnnealingScene, state: AnnealingState, rules: AnnealingRules, count: int
) -> None:
    """Make moves; calls that continue one another do the same as one call.

    No two bodies are ever closer than their margin: a body moves only as far as nothing is in its way, or it is
    re-inserted along a path from above. So all bodies can be taken out again by continuous motions.

    Parameters
    ----------
    shapes
        Shapes of all bodies, for the collision queries.
    scene, rules
        See `begin`.
    state
        After `begin`; modified in place.
    count
        Number of moves.
    """
    for _ in range(count):
        temperature = _cool(scene, state, rules)
        state.counts[DONE] += 1
        state.counts[STALE] += 1
        body = _pick(state)
        # the thesis's improved order: first decide whether the body may leave, then compute a move
        may_leave = uniform(state.random) < np.exp(-scene.weight[body] / temperature)
        kind = uniform(state.random)
        if kind < rules.drops:
            accepted = reinsert(shapes, scene, state, body, may_leave, temperature)
        elif kind < rules.drops + rules.turns:
            accepted = rotate(shapes, scene, state, rules, body, may_leave, temperature)
        else:
            accepted = translate(shapes, scene, state, rules, body, may_leave, temperature)
        if accepted:
            _commit(scene, state, body)
            _remember(scene, state, rules)


@kernel
def count_collisions(shapes: Shapes, scene: AnnealingScene, state: AnnealingState) -> int:
    """Return the number of pairs of bodies, at least one of them movable, that are closer than their margin."""
    return int(collisions(shapes, scene, state))
