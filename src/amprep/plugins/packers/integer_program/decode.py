"""Convert the values of a program's variables to an arrangement with exact positions, and back."""

from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.kernels.boxes.records import Arrangement
from amprep.model.control import Stop
from amprep.plugins.packers.integer_program.data import ModelBox, ModelData, Pair
from amprep.plugins.packers.integer_program.variables import Variable, Variables


class PlacedCopy(NamedTuple):
    """The build of a placed copy of an item, and the index of its orientation within the copy."""

    build: int
    orientation: int


def read_arrangement(data: ModelData, variables: Variables) -> Arrangement | None:
    """Return the arrangement of a solution, each item as near to the lower corner as its directions allow.

    A solver satisfies constraints to within a tolerance only. So one direction for each pair is taken from it, the
    one along which the boxes are farthest apart, and the positions follow exactly. The result is None when these
    positions are not inside the room.
    """
    placed = _placed_copies(variables)
    at = np.array([[axis.varValue for axis in position] for position in variables.position])
    relations = [
        (pair, number)
        for pair, directions in zip(data.pairs, variables.direction, strict=True)
        if _are_together(data, placed, pair)
        for number in _widest(data, placed, at, pair, directions)
    ]
    for slack in (0.0, data.instance.space.slack):
        positions = _least_positions(data, placed, relations, slack)
        if positions is not None:
            return _arrangement(data, placed, positions)
    return None


def _placed_copies(variables: Variables) -> dict[int, PlacedCopy]:
    """Return the copies that are placed, by number."""
    found = {}
    for copy, builds in enumerate(variables.inside):
        for build, inside in enumerate(builds):
            if inside.varValue > 0.5:
                turned = [variable.varValue for variable in variables.turned[copy]] or [1.0]
                found[copy] = PlacedCopy(build, int(np.argmax(turned)))
    return found


def _are_together(data: ModelData, placed: dict[int, PlacedCopy], pair: Pair) -> bool:
    """Return whether both boxes are in one build."""
    one = placed.get(pair.one.copy)
    if one is None:
        return False
    if pair.other.copy < 0:
        return data.obstacles[pair.other.number].everywhere or one.build == 0
    other = placed.get(pair.other.copy)
    return other is not None and one.build == other.build


def _least_positions(
    data: ModelData, placed: dict[int, PlacedCopy], relations: list[tuple[Pair, int]], slack: float
) -> Floats | None:
    """Return the least positions ``(copies, 3)`` mm that satisfy the relations, by longest paths.

    The result is None when there are none inside the room.
    """
    space = data.instance.space
    position = np.tile(space.lo, (len(data.copies), 1))
    size = np.array(
        [copy.size[placed[n].orientation if n in placed else 0] for n, copy in enumerate(data.copies)]
    )
    most = np.where([False, False, space.flat], space.lo + space.slack, space.hi + space.slack - size)
    for _ in range(3 * len(data.copies) + 2):
        moved = False
        for pair, number in relations:
            axis = number // 2
            near, far = (pair.one, pair.other) if number % 2 == 0 else (pair.other, pair.one)
            wanted = _corner(data, placed, position, near, axis, upper=True) + pair.gap - slack
            missing = wanted - _corner(data, placed, position, far, axis, upper=False)
            if missing > 1e-12 * max(1.0, abs(wanted)):
                if far.copy < 0 and missing > space.slack - slack:
                    return None
                if far.copy >= 0:
                    position[far.copy, axis] += missing
                    moved = True
        numbers = list(placed)
        if (position[numbers] > most[numbers]).any():
            return None
        if not moved:
            return position
    return None


def _widest(
    data: ModelData,
    placed: dict[int, PlacedCopy],
    position: Floats,
    pair: Pair,
    directions: list[Variable | None],
) -> list[int]:
    """Return the number of the direction in a solution along which two placed boxes are farthest apart, if any."""

    def distance(number: int) -> float:
        near, far = (pair.one, pair.other) if number % 2 == 0 else (pair.other, pair.one)
        lower = _corner(data, placed, position, far, number // 2, upper=False)
        return lower - _corner(data, placed, position, near, number // 2, upper=True)

    held = [number for number, each in enumerate(directions) if each is not None and each.varValue < 0.5]
    return sorted(held, key=distance)[-1:]


def _corner(
    data: ModelData,
    placed: dict[int, PlacedCopy],
    position: Floats,
    box: ModelBox,
    axis: int,
    *,
    upper: bool,
) -> float:
    """Return a coordinate of the lower or upper corner of a placed box."""
    if box.copy < 0:
        return float((box.least_hi if upper else box.least_lo)[axis])
    copy = data.copies[box.copy]
    own = (copy.hi if upper else copy.lo)[placed[box.copy].orientation, box.number, axis]
    return float(position[box.copy, axis] + own)


def _arrangement(data: ModelData, placed: dict[int, PlacedCopy], positions: Floats) -> Arrangement:
    """Return the placed copies as an arrangement, with builds numbered from 0 without gaps."""
    found = Arrangement.unassigned(len(data.instance.type_of))
    # a solver may leave a build empty; fixed items keep the first one
    fixed = {0} if data.instance.problem.fixed else set()
    used = sorted({copy.build for copy in placed.values()} | fixed)
    for number, chosen in placed.items():
        copy = data.copies[number]
        found.build[copy.item] = used.index(chosen.build)
        found.orientation[copy.item] = copy.orientations[chosen.orientation]
        found.position[copy.item] = positions[number]
    return found


def start_values(data: ModelData, variables: Variables, known: Arrangement, stop: Stop) -> dict[Any, float]:
    """Return the values of the variables for a known arrangement in canonical form, as far as `stop` allows."""
    known = canonical(data, known)
    values: dict[Any, float] = {}
    for number, copy in enumerate(data.copies):
        build, orientation = int(known.build[copy.item]), int(known.orientation[copy.item])
        here = build >= 0 and orientation in copy.orientations
        for b, inside in enumerate(variables.inside[number]):
            values[inside] = float(here and b == build)
        for o, turned in zip(copy.orientations, variables.turned[number], strict=False):
            values[turned] = float(here and o == orientation)
        corner = np.clip(known.position[copy.item], copy.least, None) if here else copy.least
        values |= dict(zip(variables.position[number], corner.tolist(), strict=True))
    for b, opened in enumerate(variables.opened):
        values[opened] = float(b < known.builds)
    for pair, directions in zip(data.pairs, variables.direction, strict=False):
        if stop():
            break
        held = holding(data, known, pair)
        values |= {v: 1.0 - h for v, h in zip(directions, held.tolist(), strict=True) if v is not None}
    return values


def canonical(data: ModelData, known: Arrangement) -> Arrangement:
    """Return the arrangement, reflected and with equal items swapped as symmetry breaking demands."""
    # a reflection along x reverses the order of equal items, so it comes before the second sorting
    found = _sorted_equals(data, _reflected(data, _sorted_equals(data, known), 0))
    for axis in (1,) if data.instance.space.flat else (1, 2):
        found = _reflected(data, found, axis)
    return found


def _sorted_equals(data: ModelData, known: Arrangement) -> Arrangement:
    """Return the arrangement with equal items sorted: used ones first, then by build, then from left to right."""
    found = known.copy()
    for run in data.alike:
        items = [data.copies[data.copies_of[rank][0]].item for rank in run]
        order = sorted(
            items, key=lambda i: (known.build[i] < 0, int(known.build[i]), *known.position[i].tolist())
        )
        for mine, theirs in zip(found, known, strict=True):
            mine[items] = theirs[order]
    return found


def _reflected(data: ModelData, known: Arrangement, axis: int) -> Arrangement:
    """Return the arrangement with the first item's build reflected if that item is in its upper half."""
    instance = data.instance
    first = data.copies[data.copies_of[0][0]].item
    build = int(known.build[first])
    if not data.reflected or build < 0:
        return known
    length = np.array([orientation.size[axis] for orientation in instance.orientations])[known.orientation]
    ends = float(instance.space.lo[axis] + instance.space.hi[axis])
    if 2.0 * known.position[first, axis] + length[first] <= ends:
        return known
    found, inside = known.copy(), known.build == build
    found.position[inside, axis] = (ends - known.position[:, axis] - length)[inside]
    return found


def holding(data: ModelData, known: Arrangement, pair: Pair) -> Bools:
    """Return the directions ``(6,)`` of a pair that hold; none when its boxes are not in one build."""
    none = np.zeros(6, dtype=bool)
    corners, builds = [], []
    for box in (pair.one, pair.other):
        if box.copy < 0:
            corners.append((box.least_lo, box.least_hi))
            continue
        copy = data.copies[box.copy]
        build, orientation = int(known.build[copy.item]), int(known.orientation[copy.item])
        if build < 0 or orientation not in copy.orientations:
            return none
        own, position = copy.orientations.index(orientation), known.position[copy.item]
        corners.append((position + copy.lo[own, box.number], position + copy.hi[own, box.number]))
        builds.append(build)
    if len(builds) == 2 and builds[0] != builds[1]:
        return none
    if len(builds) == 1 and builds[0] != 0 and not data.obstacles[pair.other.number].everywhere:
        return none
    (lo, hi), (other_lo, other_hi) = corners
    apart = np.stack((hi + pair.required <= other_lo, other_hi + pair.required <= lo), axis=1).ravel()
    return np.asarray(apart & pair.possible)
