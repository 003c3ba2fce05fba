"""The variables of the packing program, and the sums of them that the constraints speak of."""

from dataclasses import dataclass
from typing import Any

import pulp

from amprep.plugins.packers.integer_program.data import Ground, Pair, Piece

Variable = Any
"""A pulp variable."""

Expression = Any
"""A pulp expression, or a number."""


@dataclass(frozen=True, eq=False)
class Variables:
    """The unknowns.

    Attributes
    ----------
    inside
        Per body and build, 1 when it is there; the thesis's *used*.
    turned
        Per body and variant, 1 when it has that orientation; empty for bodies that have one.
    position
        Per body the coordinates of the least corner.
    direction
        Per pair: right, left, up, down, front, back; 0 when the second piece is on that side of the first,
        1 when it need not be; None where there is no room for it.
    opened
        Per build, 1 when it holds an item; empty in a fill problem.
    """

    inside: list[list[Variable]]
    turned: list[list[Variable]]
    position: list[list[Variable]]
    direction: list[list[Variable | None]]
    opened: list[Variable]

    def used(self, body: int) -> Expression:
        """Return 1 when the body is in some build."""
        return pulp.lpSum(self.inside[body])


def make_variables(problem: pulp.LpProblem, ground: Ground) -> Variables:
    """Return new variables of `problem`, over `ground`."""
    bodies = range(len(ground.bodies))
    return Variables(
        inside=[[_binary(problem, f"inside_{a}_{b}") for b in range(ground.builds)] for a in bodies],
        turned=[
            [_binary(problem, f"turned_{a}_{v}") for v in range(len(body.variants))]
            if len(body.variants) > 1
            else []
            for a, body in enumerate(ground.bodies)
        ],
        position=[
            [
                problem.add_variable(f"{axis}_{a}", float(least), float(most))
                for axis, least, most in zip("xyz", body.least, body.most, strict=True)
            ]
            for a, body in enumerate(ground.bodies)
        ],
        direction=[_directions(problem, number, pair) for number, pair in enumerate(ground.pairs)],
        opened=[] if ground.filling else [_binary(problem, f"opened_{b}") for b in range(ground.builds)],
    )


def _directions(problem: pulp.LpProblem, number: int, pair: Pair) -> list[Variable | None]:
    names = ("right", "left", "up", "down", "front", "back")
    return [
        _binary(problem, f"{name}_{number}") if possible else None
        for name, possible in zip(names, pair.possible.tolist(), strict=True)
    ]


def _binary(problem: pulp.LpProblem, name: str) -> Variable:
    return problem.add_variable(name, cat=pulp.LpBinary)


def corner(ground: Ground, variables: Variables, piece: Piece, axis: int, *, upper: bool) -> Expression:
    """Return a piece's lower or upper corner: its body's position plus its place within the body.

    This is the substitution of thesis 2.3: the boxes of one item share its three coordinates.
    """
    if piece.body < 0:
        return float((piece.least_hi if upper else piece.least_lo)[axis])
    body = ground.bodies[piece.body]
    offsets = (body.hi if upper else body.lo)[:, piece.box, axis].tolist()
    return variables.position[piece.body][axis] + within(variables, piece.body, offsets)


def within(variables: Variables, body: int, offsets: list[float]) -> Expression:
    """Return the one of a body's `offsets`, one for each variant, that its orientation chooses."""
    if len(offsets) == 1:
        return offsets[0]
    return pulp.LpAffineExpression(list(zip(variables.turned[body], offsets, strict=True)))
