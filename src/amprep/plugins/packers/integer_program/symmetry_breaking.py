"""Constraints that leave one of many packings that differ only in names or by reflection.

All of them hold in the packing whose list of build numbers, item by item, comes first in the dictionary among
those that renaming builds and swapping equal items give; the orders in space then cost nothing further.
"""

from collections.abc import Iterator
from itertools import pairwise

import pulp

from amprep.plugins.packers.integer_program.constraints import Constraint, Program
from amprep.plugins.packers.integer_program.data import Ground
from amprep.plugins.packers.integer_program.variables import Expression, Variables, within


def builds_in_order(program: Program) -> Iterator[Constraint]:
    """Build b + 1 is opened after build b, and the item of rank r is in one of the builds 0 to r."""
    ground, variables = program.ground, program.variables
    if not program.params.symmetry or ground.filling:
        return
    for earlier, later in pairwise(variables.opened):
        yield earlier >= later
    first = 1 if ground.scene.problem.fixed else 0  # that build has a name of its own
    for rank, copies in enumerate(ground.copies):
        for build in range(rank + first + 1, ground.builds):
            yield pulp.lpSum(variables.inside[body][build] for body in copies) == 0


def equal_items_in_order(program: Program) -> Iterator[Constraint]:
    """Of equal items the earlier one is used first, or is in the earlier build."""
    for run in program.ground.alike:
        for one, other in pairwise(run):
            yield _lead(program.ground, program.variables, one, other) >= 0


def equal_boxes_left_to_right(program: Program) -> Iterator[Constraint]:
    """Of equal boxes in one build the earlier one is not right of the later one."""
    ground, variables = program.ground, program.variables
    for run in ground.ordered:
        for one, other in pairwise(run):
            body, next_body = ground.copies[one][0], ground.copies[other][0]
            width = float(ground.bodies[body].most[0] - ground.bodies[body].least[0])
            lead = _lead(ground, variables, one, other)
            yield variables.position[body][0] <= variables.position[next_body][0] + width * lead


def _lead(ground: Ground, variables: Variables, one: int, other: int) -> Expression:
    """Return 0 when both items are in one build or unused, else how far the first one is ahead."""

    def number(rank: int) -> Expression:
        terms = []
        for body in ground.copies[rank]:
            for build, inside in enumerate(variables.inside[body]):
                terms.append((inside, 1 if ground.filling else -build))
        return pulp.LpAffineExpression(terms)

    return number(one) - number(other)


def first_item_in_lower_half(program: Program) -> Iterator[Constraint]:
    """Keep the first item's centre in the lower half along each axis, when a packing may be reflected."""
    ground, variables = program.ground, program.variables
    if not ground.reflected:
        return
    space = ground.scene.space
    for body in ground.copies[0]:
        for axis in range(2 if space.flat else 3):
            size = within(variables, body, ground.bodies[body].size[:, axis].tolist())
            yield 2 * variables.position[body][axis] + size <= float(space.lo[axis] + space.hi[axis])
