"""The integer program of thesis 2.2 for packing: its constraints, one function for each sentence."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise

import pulp

from amprep.arrays import CONTACT_TOLERANCE
from amprep.model.control import Stop
from amprep.plugins.packers.bounds.combinatorial import amounts_of
from amprep.plugins.packers.integer_program.data import ModelData, Pair
from amprep.plugins.packers.integer_program.variables import (
    Constraint,
    Expression,
    Program,
    Variables,
    corner,
    make_variables,
    offset_of,
)
from amprep.plugins.packers.params import IpParams


def separation(program: Program) -> Iterator[Constraint]:
    """If a direction is 0, the second box is beyond the first on that side, by the distance required there."""
    data, variables = program.data, program.variables
    for pair, directions in zip(data.pairs, variables.direction, strict=True):
        for number, direction in enumerate(directions):
            if direction is None:
                continue
            axis = number // 2
            near, far = (pair.one, pair.other) if number % 2 == 0 else (pair.other, pair.one)
            before = corner(data, variables, near, axis, upper=True)
            beyond = corner(data, variables, far, axis, upper=False)
            big = _big_m(program, pair, number)
            yield before + float(pair.required[axis]) <= beyond + big * direction


def _big_m(program: Program, pair: Pair, number: int) -> float:
    """Return the greatest violation of a separation: the room's side, or the least value for the pair's ranges."""
    axis, space = number // 2, program.data.instance.space
    if not program.params.tighten and pair.other.copy >= 0:
        return float(space.hi[axis] - space.lo[axis] + pair.required[axis]) + 3.0 * space.slack
    near, far = (pair.one, pair.other) if number % 2 == 0 else (pair.other, pair.one)
    return max(0.0, float(near.most_hi[axis] - far.least_lo[axis] + pair.required[axis]))


def apart(program: Program) -> Iterator[Constraint]:
    """Two boxes in one build have at least one direction, so not all directions are 1."""
    data, variables = program.data, program.variables
    for pair, directions in zip(data.pairs, variables.direction, strict=True):
        known = [direction for direction in directions if direction is not None]
        for presence in _meetings(data, variables, pair):
            yield pulp.lpSum(known) <= len(known) + 1 - presence


def _meetings(data: ModelData, variables: Variables, pair: Pair) -> Iterator[Expression]:
    """Yield expressions that are 2 when the boxes are in one build, and at most 1 otherwise."""
    one = pair.one.copy
    if pair.other.copy >= 0:
        for mine, yours in zip(variables.inside[one], variables.inside[pair.other.copy], strict=True):
            yield mine + yours
    elif data.obstacles[pair.other.number].everywhere:
        yield 1 + variables.used(one)
    else:
        yield 1 + variables.inside[one][0]


def once(program: Program) -> Iterator[Constraint]:
    """One copy of every item is in one build; in a fill problem at most one."""
    for own in program.data.copies_of:
        used = pulp.lpSum(program.variables.used(copy) for copy in own)
        yield used <= 1 if program.data.filling else used == 1


def orientation(program: Program) -> Iterator[Constraint]:
    """A copy with several orientations has one of them when it is in a build, else none."""
    for copy, turned in enumerate(program.variables.turned):
        if turned:
            yield pulp.lpSum(turned) == program.variables.used(copy)


def inside_room(program: Program) -> Iterator[Constraint]:
    """A copy with several orientations is inside the room in each of them."""
    space = program.data.instance.space
    for number, copy in enumerate(program.data.copies):
        if program.variables.turned[number]:
            for axis in range(2 if space.flat else 3):
                size = offset_of(program.variables, number, copy.size[:, axis].tolist())
                position = program.variables.position[number][axis]
                yield position + size <= float(space.hi[axis] + space.slack)


def opened(program: Program) -> Iterator[Constraint]:
    """A build with an item is open; fixed items open the first build."""
    variables, fixed = program.variables, program.data.instance.problem.fixed
    for build, variable in enumerate(variables.opened):
        for inside in variables.inside:
            yield inside[build] <= variable
    if variables.opened and fixed:
        yield variables.opened[0] == 1


def amounts(program: Program) -> Iterator[Constraint]:
    """The items of a build take no more volume, or without stacking plate area, than it has."""
    data, variables = program.data, program.variables
    if not program.params.tighten:
        return
    for taken, room in amounts_of(data.instance):
        fractions = (taken / room)[data.instance.type_of]
        for build in range(data.builds):
            terms = [
                (variables.inside[a][build], float(fractions[copy.item]))
                for a, copy in enumerate(data.copies)
            ]
            most = variables.opened[build] if variables.opened else 1
            yield pulp.LpAffineExpression(terms) <= most


def one_side(program: Program) -> Iterator[Constraint]:
    """No box is on both sides of another along an axis."""
    if not program.params.tighten:
        return
    thin = 2.0 * CONTACT_TOLERANCE
    for pair, directions in zip(program.data.pairs, program.variables.direction, strict=True):
        for axis in range(3):
            one, other = directions[2 * axis : 2 * axis + 2]
            thick = _least_side(program.data, pair, axis) + 2.0 * float(pair.required[axis]) > thin
            if one is not None and other is not None and thick:
                yield one + other >= 1


def _least_side(data: ModelData, pair: Pair, axis: int) -> float:
    """Return the sum of the least lengths of both boxes along an axis."""
    total = 0.0
    for box in (pair.one, pair.other):
        if box.copy < 0:
            total += float(box.least_hi[axis] - box.least_lo[axis])
        else:
            copy = data.copies[box.copy]
            total += float((copy.hi - copy.lo)[:, box.number, axis].min())
    return total


def builds_in_order(program: Program) -> Iterator[Constraint]:
    """Build b + 1 is opened after build b, and the item of rank r is in one of the builds 0 to r."""
    data, variables = program.data, program.variables
    if not program.params.symmetry or data.filling:
        return
    for earlier, later in pairwise(variables.opened):
        yield earlier >= later
    first = 1 if data.instance.problem.fixed else 0  # the build of the fixed items cannot be renamed
    for rank, own in enumerate(data.copies_of):
        for build in range(rank + first + 1, data.builds):
            yield pulp.lpSum(variables.inside[copy][build] for copy in own) == 0


def equal_items_in_order(program: Program) -> Iterator[Constraint]:
    """Yield the constraints that use the earlier one of two equal items first and put it in the earlier build."""
    for run in program.data.alike:
        for one, other in pairwise(run):
            yield _lead(program.data, program.variables, one, other) >= 0


def equal_boxes_left_to_right(program: Program) -> Iterator[Constraint]:
    """Yield the constraints that keep the earlier one of two equal boxes in a build left of the later one."""
    data, variables = program.data, program.variables
    for run in data.ordered:
        for one, other in pairwise(run):
            copy, next_copy = data.copies_of[one][0], data.copies_of[other][0]
            width = float(data.copies[copy].most[0] - data.copies[copy].least[0])
            lead = _lead(data, variables, one, other)
            yield variables.position[copy][0] <= variables.position[next_copy][0] + width * lead


def _lead(data: ModelData, variables: Variables, one: int, other: int) -> Expression:
    """Return the number of builds by which the first item is ahead; 0 if both are in one build or unused."""

    def number(rank: int) -> Expression:
        terms = []
        for copy in data.copies_of[rank]:
            for build, inside in enumerate(variables.inside[copy]):
                terms.append((inside, 1 if data.filling else -build))
        return pulp.LpAffineExpression(terms)

    return number(one) - number(other)


def first_item_in_lower_half(program: Program) -> Iterator[Constraint]:
    """The centre of the first item is in the lower half along each axis, when a packing may be reflected."""
    data, variables = program.data, program.variables
    if not data.reflected:
        return
    space = data.instance.space
    for copy in data.copies_of[0]:
        for axis in range(2 if space.flat else 3):
            size = offset_of(variables, copy, data.copies[copy].size[:, axis].tolist())
            yield 2 * variables.position[copy][axis] + size <= float(space.lo[axis] + space.hi[axis])


Family = Callable[[Program], Iterable[Constraint]]
"""Yields the constraints that its docstring states."""

FAMILIES: tuple[Family, ...] = (
    separation,
    apart,
    once,
    orientation,
    inside_room,
    opened,
    amounts,
    one_side,
    builds_in_order,
    equal_items_in_order,
    equal_boxes_left_to_right,
    first_item_in_lower_half,
)
"""The last four break symmetries: each leaves one of many arrangements that differ in names or by reflection only.

All four hold in the arrangement whose list of build numbers, item by item, is the first in lexicographic order among
those that result from renaming builds and swapping equal items; the orders in space exclude no further arrangements.
"""


def make_program(
    data: ModelData, params: IpParams, stop: Stop, further: Sequence[Family] = ()
) -> tuple[pulp.LpProblem, Variables]:
    """Return the program of thesis 2.2 for the most value in one build, or the fewest builds.

    When told to stop, the result is incomplete.

    With clearance, boxes are that far apart along an axis, which is more than the judge demands at corners, unless
    the data are relaxed.

    Parameters
    ----------
    further
        More families of constraints, for example the neighbourhood of a local search.
    """
    sense = pulp.LpMaximize if data.filling else pulp.LpMinimize
    problem = pulp.LpProblem("packing", sense)
    variables = make_variables(problem, data, stop)
    problem.setObjective(_value(data, variables) if data.filling else pulp.lpSum(variables.opened))
    program = Program(data, variables, params, problem)
    for family in (*FAMILIES, *further):
        if stop():
            break
        for constraint in family(program):
            if stop():
                break
            problem.addConstraint(constraint)
    return problem, variables


def _value(data: ModelData, variables: Variables) -> Expression:
    """Return the value of the used items, in units of the greatest value."""
    unit, items = data.value_unit, data.instance.problem.items
    terms = [
        (inside, items[copy.item].value / unit)
        for copy, builds in zip(data.copies, variables.inside, strict=True)
        for inside in builds
    ]
    return pulp.LpAffineExpression(terms)
