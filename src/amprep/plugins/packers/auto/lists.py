"""Lists of orientations for packers that take no other ones."""

from dataclasses import replace

from amprep.model.packing import PackingProblem
from amprep.model.part import Orientations
from amprep.model.rotations import quarter_turns


def in_lists(problem: PackingProblem) -> PackingProblem:
    """Return the problem with quarter turns about z instead of any angle about z.

    A bound for such an item is none for the part.
    """
    if all(item.orientations.freedom == "list" for item in problem.items):
        return problem
    turns = Orientations("list", quarter_turns())
    items = tuple(
        item if item.orientations.freedom == "list" else replace(item, orientations=turns, exact=False)
        for item in problem.items
    )
    return replace(problem, items=items)
