"""The variables of the packing program, and the expressions in them that the constraints use."""

from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import pulp

from amprep.model.control import Stop
from amprep.plugins.packers.integer_program.data import ModelBox, ModelData, Pair
from amprep.plugins.packers.params import IpParams

Variable = Any
"""A pulp variable."""

Expression = Any
"""A pulp expression, or a number."""

Constraint = Any
"""A pulp constraint."""


@dataclass(frozen=True, eq=False)
class Variables:
    """The variables.

    Attributes
    ----------
    inside
        Per copy and build: 1 when the copy is in the build; the thesis's *used*.
    turned
        Per copy and orientation: 1 when the copy has that orientation; empty for copies with one orientation.
    position
        Per copy: the coordinates of the least corner.
    direction
        Per pair: right, left, up, down, front, back; 0 when the second box is on that side of the first, 1 when it
        need not be; None where there is no room for it.
    opened
        Per build: 1 when it holds an item; empty in a fill problem.
    """

    inside: list[list[Variable]]
    turned: list[list[Variable]]
    position: list[list[Variable]]
    direction: list[list[Variable | None]]
    opened: list[Variable]

    def used(self, copy: int) -> Expression:
        """Return 1 when the copy is in some build."""
        return pulp.lpSum(self.inside[copy])


@dataclass(frozen=True, eq=False)
class Program:
    """Data, variables and parameters, from which constraints are made; `problem` takes further variables."""

    data: ModelData
    variables: Variables
    params: IpParams
    problem: pulp.LpProblem


def make_variables(problem: pulp.LpProblem, data: ModelData, stop: Stop) -> Variables:
    """Return new variables of `problem`, as far as `stop` allows."""
    copies = range(len(data.copies))
    pairs = enumerate(data.pairs)
    directions = [
        _directions(problem, number, pair) for number, pair in takewhile(lambda _: not stop(), pairs)
    ]
    return Variables(
        inside=[[_binary(problem, f"inside_{a}_{b}") for b in range(data.builds)] for a in copies],
        turned=[
            [_binary(problem, f"turned_{a}_{v}") for v in range(len(copy.orientations))]
            if len(copy.orientations) > 1
            else []
            for a, copy in enumerate(data.copies)
        ],
        position=[
            [
                problem.add_variable(f"{axis}_{a}", float(least), float(most))
                for axis, least, most in zip("xyz", copy.least, copy.most, strict=True)
            ]
            for a, copy in enumerate(data.copies)
        ],
        direction=directions,
        opened=[] if data.filling else [_binary(problem, f"opened_{b}") for b in range(data.builds)],
    )


def _directions(problem: pulp.LpProblem, number: int, pair: Pair) -> list[Variable | None]:
    names = ("right", "left", "up", "down", "front", "back")
    return [
        _binary(problem, f"{name}_{number}") if possible else None
        for name, possible in zip(names, pair.possible.tolist(), strict=True)
    ]


def _binary(problem: pulp.LpProblem, name: str) -> Variable:
    return problem.add_variable(name, cat=pulp.LpBinary)


def corner(data: ModelData, variables: Variables, box: ModelBox, axis: int, *, upper: bool) -> Expression:
    """Return a coordinate of a box's lower or upper corner: the position of its copy plus its offset in the copy.

    This is the substitution of thesis 2.3: the boxes of one item share its three coordinates.
    """
    if box.copy < 0:
        return float((box.least_hi if upper else box.least_lo)[axis])
    copy = data.copies[box.copy]
    offsets = (copy.hi if upper else copy.lo)[:, box.number, axis].tolist()
    return variables.position[box.copy][axis] + offset_of(variables, box.copy, offsets)


def offset_of(variables: Variables, copy: int, offsets: list[float]) -> Expression:
    """Return that one of the offsets, one for each orientation, which the orientation of the copy selects."""
    if len(offsets) == 1:
        return offsets[0]
    return pulp.LpAffineExpression(list(zip(variables.turned[copy], offsets, strict=True)))
