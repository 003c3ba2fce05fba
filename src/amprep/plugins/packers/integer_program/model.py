"""The thesis's integer program for packing: variables, constraints and objective put together."""

from collections.abc import Callable, Iterable, Sequence

import pulp

from amprep.plugins.packers.integer_program import constraints as rules
from amprep.plugins.packers.integer_program import symmetry_breaking as symmetry
from amprep.plugins.packers.integer_program.constraints import Constraint, Program
from amprep.plugins.packers.integer_program.data import Ground
from amprep.plugins.packers.integer_program.variables import Expression, Variables, make_variables
from amprep.plugins.packers.params import IpParams

Family = Callable[[Program], Iterable[Constraint]]
"""Yields the constraints that its docstring states."""

FAMILIES: tuple[Family, ...] = (
    rules.separation,
    rules.apart,
    rules.once,
    rules.orientation,
    rules.inside_room,
    rules.opened,
    rules.amounts,
    rules.one_side,
    symmetry.builds_in_order,
    symmetry.equal_items_in_order,
    symmetry.equal_boxes_left_to_right,
    symmetry.first_item_in_lower_half,
)


def make_program(
    ground: Ground, params: IpParams, further: Sequence[Family] = ()
) -> tuple[pulp.LpProblem, Variables]:
    """Return the program of thesis 2.2 for the most value in one build, or the fewest builds.

    `further` families narrow it, as a local search does. With clearance, pieces are that far apart along an
    axis, which is more than the judge asks for at corners.
    """
    sense = pulp.LpMaximize if ground.filling else pulp.LpMinimize
    problem = pulp.LpProblem("packing", sense)
    variables = make_variables(problem, ground)
    problem.setObjective(_value(ground, variables) if ground.filling else pulp.lpSum(variables.opened))
    program = Program(ground, variables, params)
    for family in (*FAMILIES, *further):
        for constraint in family(program):
            problem.addConstraint(constraint)
    return problem, variables


def value_unit(ground: Ground) -> float:
    """Return the greatest value of an item: the objective counts in it, so that tolerances mean the same."""
    return max((ground.scene.problem.items[body.item].value for body in ground.bodies), default=1.0) or 1.0


def _value(ground: Ground, variables: Variables) -> Expression:
    """Return the value of what is used, in units of the greatest one."""
    unit, items = value_unit(ground), ground.scene.problem.items
    terms = [
        (inside, items[body.item].value / unit)
        for body, builds in zip(ground.bodies, variables.inside, strict=True)
        for inside in builds
    ]
    return pulp.LpAffineExpression(terms)
