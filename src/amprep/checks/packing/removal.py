"""Check that an order takes the parts of a build out without collisions, by sampled motions of solids."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Floats
from amprep.checks.violation import Violation
from amprep.geometry.removal.order import RemovalOrder, RemovalStep

if TYPE_CHECKING:
    from manifold3d import Manifold

OVERLAP = 1e-2
"""mm3; a smaller intersection of two solids is contact."""


def check_removal_order(
    solids: Sequence["Manifold"], names: Sequence[str], order: RemovalOrder, stride: float
) -> list[Violation]:
    """Return the violations of a removal order.

    Every body leaves once by itself or is locked, and no motion makes solids intersect at one of the sampled positions.
    Groups that leave together are taken apart by later steps, or are locked.

    Parameters
    ----------
    solids
        The bodies of a build.
    names
        Their names.
    order
        The order to check.
    stride
        mm between positions of a motion; what is thinner may be passed unnoticed.
    """
    here: dict[int, tuple[int, ...]] = dict.fromkeys(
        range(len(solids)), ()
    )  # the group that a body left with
    found: list[Violation] = []
    for step in order.steps:
        if any(here.get(body) != step.within for body in step.bodies):
            wrong = " and ".join(names[body] for body in step.bodies)
            found.append(Violation("removal order", wrong, "it is not where the step takes it from"))
            continue
        others = [body for body, group in here.items() if group == step.within and body not in step.bodies]
        found += _collisions(solids, names, step, others, stride)
        for body in step.bodies:
            if len(step.bodies) == 1:
                del here[body]
            else:
                here[body] = step.bodies
    excused = {body for group in order.locked for body in group} | set(order.unknown)
    stays = [
        Violation("removal order", names[body], "it does not leave") for body in here if body not in excused
    ]
    return found + stays


def _collisions(
    solids: Sequence["Manifold"],
    names: Sequence[str],
    step: RemovalStep,
    others: Sequence[int],
    stride: float,
) -> list[Violation]:
    """Return a violation for each body that another meets at a sampled position of a step."""
    found = []
    for body in step.bodies:
        for other in others:
            met = next(
                (
                    offset
                    for offset in _offsets(step, solids[body], solids[other], stride)
                    if (solids[body].translate(offset.tolist()) ^ solids[other]).volume() > OVERLAP
                ),
                None,
            )
            if met is not None:
                where = ", ".join(f"{value:.3g}" for value in met)
                message = f"it meets {names[other]} after a motion by ({where}) mm"
                found.append(Violation("removal order", names[body], message))
    return found


def _offsets(step: RemovalStep, solid: "Manifold", other: "Manifold", stride: float) -> list[Floats]:
    """Return the sampled offsets of the motions of a step; the last one ends where the boxes are apart."""
    reach = (
        float(np.ptp(np.array([solid.bounding_box(), other.bounding_box()]).reshape(-1, 3), axis=0).max())
        * 2.0
    )
    start, offsets = np.zeros(3), []
    for direction, length in step.path:
        end = min(length, reach + float(np.abs(start).sum()))
        samples = np.linspace(0.0, end, max(2, int(np.ceil(end / stride)) + 1))
        offsets += [start + travel * np.array(direction) for travel in samples]
        start = start + end * np.array(direction)
    return offsets
