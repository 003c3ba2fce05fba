"""The constraints of the packing program, one function for each sentence."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pulp

from amprep.arrays import CONTACT_TOLERANCE
from amprep.plugins.packers.bounds.volume import amounts_of
from amprep.plugins.packers.integer_program.data import Ground, Pair
from amprep.plugins.packers.integer_program.variables import Expression, Variables, corner, within
from amprep.plugins.packers.params import IpParams

Constraint = Any
"""A pulp constraint."""


@dataclass(frozen=True, eq=False)
class Program:
    """What a constraint may speak of."""

    ground: Ground
    variables: Variables
    params: IpParams


def separation(program: Program) -> Iterator[Constraint]:
    """If a direction is 0, the second piece lies beyond the first on that side, `gap` away."""
    ground, variables = program.ground, program.variables
    slack = ground.scene.space.slack
    for pair, directions in zip(ground.pairs, variables.direction, strict=True):
        for number, direction in enumerate(directions):
            if direction is None:
                continue
            axis = number // 2
            near, far = (pair.one, pair.other) if number % 2 == 0 else (pair.other, pair.one)
            before = corner(ground, variables, near, axis, upper=True)
            beyond = corner(ground, variables, far, axis, upper=False)
            big = _big_m(program, pair, number)
            yield before + (pair.gap - slack) <= beyond + big * direction


def _big_m(program: Program, pair: Pair, number: int) -> float:
    """Return by how much a separation must give at most: plainly the room's side, or the pieces' reach."""
    axis, space = number // 2, program.ground.scene.space
    if not program.params.tighten and pair.other.body >= 0:
        return float(space.hi[axis] - space.lo[axis]) + pair.gap + 2.0 * space.slack
    near, far = (pair.one, pair.other) if number % 2 == 0 else (pair.other, pair.one)
    return max(0.0, float(near.most_hi[axis] - far.least_lo[axis]) + pair.gap - space.slack)


def apart(program: Program) -> Iterator[Constraint]:
    """Two pieces in one build have at least one direction, so not all directions are 1."""
    ground, variables = program.ground, program.variables
    for pair, directions in zip(ground.pairs, variables.direction, strict=True):
        known = [direction for direction in directions if direction is not None]
        for presence in _meetings(ground, variables, pair):
            yield pulp.lpSum(known) <= len(known) + 1 - presence


def _meetings(ground: Ground, variables: Variables, pair: Pair) -> Iterator[Expression]:
    """Yield sums that are 2 when the pieces are in one build, and at most 1 otherwise."""
    one = pair.one.body
    if pair.other.body >= 0:
        for mine, yours in zip(variables.inside[one], variables.inside[pair.other.body], strict=True):
            yield mine + yours
    elif ground.obstacles[pair.other.box].everywhere:
        yield 1 + variables.used(one)
    else:
        yield 1 + variables.inside[one][0]


def once(program: Program) -> Iterator[Constraint]:
    """Every item is in one build in one of its copies; in a fill problem in at most one."""
    for copies in program.ground.copies:
        used = pulp.lpSum(program.variables.used(body) for body in copies)
        yield used <= 1 if program.ground.filling else used == 1


def orientation(program: Program) -> Iterator[Constraint]:
    """Give a body that shares its alternatives one orientation when it is in a build, else none."""
    for body, turned in enumerate(program.variables.turned):
        if turned:
            yield pulp.lpSum(turned) == program.variables.used(body)


def inside_room(program: Program) -> Iterator[Constraint]:
    """Keep a body that shares its alternatives inside the room however it is turned."""
    space = program.ground.scene.space
    for number, body in enumerate(program.ground.bodies):
        if program.variables.turned[number]:
            for axis in range(2 if space.flat else 3):
                size = within(program.variables, number, body.size[:, axis].tolist())
                position = program.variables.position[number][axis]
                yield position + size <= float(space.hi[axis] + space.slack)


def opened(program: Program) -> Iterator[Constraint]:
    """Open the build that something is in; what stands in the first build already opens that."""
    variables, fixed = program.variables, program.ground.scene.problem.fixed
    for build, variable in enumerate(variables.opened):
        for inside in variables.inside:
            yield inside[build] <= variable
    if variables.opened and fixed:
        yield variables.opened[0] == 1


def amounts(program: Program) -> Iterator[Constraint]:
    """Take no more volume in a build, or plate area without stacking, than there is."""
    ground, variables = program.ground, program.variables
    if not program.params.tighten:
        return
    for taken, room in amounts_of(ground.scene):
        shares = (taken / room)[ground.scene.kind]
        for build in range(ground.builds):
            terms = [
                (variables.inside[a][build], float(shares[body.item])) for a, body in enumerate(ground.bodies)
            ]
            most = variables.opened[build] if variables.opened else 1
            yield pulp.LpAffineExpression(terms) <= most


def one_side(program: Program) -> Iterator[Constraint]:
    """No piece is on both sides of another along an axis."""
    if not program.params.tighten:
        return
    thin = 4.0 * CONTACT_TOLERANCE
    for pair, directions in zip(program.ground.pairs, program.variables.direction, strict=True):
        for axis in range(3):
            one, other = directions[2 * axis : 2 * axis + 2]
            thick = _least_side(program.ground, pair, axis) + 2.0 * pair.gap > thin
            if one is not None and other is not None and thick:
                yield one + other >= 1


def _least_side(ground: Ground, pair: Pair, axis: int) -> float:
    """Return the sum of the pieces' least lengths along an axis."""
    total = 0.0
    for piece in (pair.one, pair.other):
        if piece.body < 0:
            total += float(piece.least_hi[axis] - piece.least_lo[axis])
        else:
            body = ground.bodies[piece.body]
            total += float((body.hi - body.lo)[:, piece.box, axis].min())
    return total
