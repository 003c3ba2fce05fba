"""From a program's values to exact places, and from places to values."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.plugins.packers.instance.arrangement import Arrangement, nothing_placed
from amprep.plugins.packers.integer_program.data import Ground, Pair, Piece
from amprep.plugins.packers.integer_program.variables import Variables


class Choice(NamedTuple):
    """A body that is placed: where, and which of its own variants."""

    build: int
    variant: int


def read_arrangement(ground: Ground, variables: Variables) -> Arrangement | None:
    """Return the packing that a solution means, each item as near to the lower corner as its directions let.

    A solver keeps constraints to within a tolerance only. So the directions alone are taken from it, and the
    places follow exactly; None when, rounded, they leave the room after all.
    """
    choices = _choices(variables)
    relations = [
        (pair, number)
        for pair, directions in zip(ground.pairs, variables.direction, strict=True)
        if _meet(ground, choices, pair)
        for number, direction in enumerate(directions)
        if direction is not None and direction.varValue < 0.5
    ]
    for slack in (0.0, ground.scene.space.slack):
        place = _least_places(ground, choices, relations, slack)
        if place is not None:
            return _arrangement(ground, choices, place)
    return None


def _choices(variables: Variables) -> dict[int, Choice]:
    """Return the bodies that are placed."""
    found = {}
    for body, builds in enumerate(variables.inside):
        for build, inside in enumerate(builds):
            if inside.varValue > 0.5:
                turned = [variable.varValue for variable in variables.turned[body]] or [1.0]
                found[body] = Choice(build, int(np.argmax(turned)))
    return found


def _meet(ground: Ground, choices: dict[int, Choice], pair: Pair) -> bool:
    """Whether both pieces are in one build."""
    one = choices.get(pair.one.body)
    if one is None:
        return False
    if pair.other.body < 0:
        return ground.obstacles[pair.other.box].everywhere or one.build == 0
    other = choices.get(pair.other.body)
    return other is not None and one.build == other.build


def _least_places(
    ground: Ground, choices: dict[int, Choice], relations: list[tuple[Pair, int]], slack: float
) -> Floats | None:
    """Return the least places ``(bodies, 3)`` that keep the relations, by longest paths; None without any."""
    space = ground.scene.space
    place = np.tile(space.lo, (len(ground.bodies), 1))
    size = np.array(
        [body.size[choices[b].variant if b in choices else 0] for b, body in enumerate(ground.bodies)]
    )
    most = np.where([False, False, space.flat], space.lo + space.slack, space.hi + space.slack - size)
    for _ in range(3 * len(ground.bodies) + 2):
        moved = False
        for pair, number in relations:
            axis = number // 2
            near, far = (pair.one, pair.other) if number % 2 == 0 else (pair.other, pair.one)
            wanted = _corner(ground, choices, place, near, axis, upper=True) + pair.gap - slack
            missing = wanted - _corner(ground, choices, place, far, axis, upper=False)
            if missing > 1e-12 * max(1.0, abs(wanted)):
                if far.body < 0 and missing > space.slack - slack:
                    return None
                if far.body >= 0:
                    place[far.body, axis] += missing
                    moved = True
        placed = list(choices)
        if (place[placed] > most[placed]).any():
            return None
        if not moved:
            return place
    return None


def _corner(
    ground: Ground, choices: dict[int, Choice], place: Floats, piece: Piece, axis: int, *, upper: bool
) -> float:
    """Return a coordinate of a placed piece."""
    if piece.body < 0:
        return float((piece.least_hi if upper else piece.least_lo)[axis])
    body = ground.bodies[piece.body]
    own = (body.hi if upper else body.lo)[choices[piece.body].variant, piece.box, axis]
    return float(place[piece.body, axis] + own)


def _arrangement(ground: Ground, choices: dict[int, Choice], place: Floats) -> Arrangement:
    found = nothing_placed(ground.scene)
    # builds are numbered as they come, for a solver may leave one empty; the first one may hold fixed items
    fixed = {0} if ground.scene.problem.fixed else set()
    names = {
        build: n for n, build in enumerate(sorted({choice.build for choice in choices.values()} | fixed))
    }
    for number, choice in choices.items():
        body = ground.bodies[number]
        found.build[body.item] = names[choice.build]
        found.variant[body.item] = body.variants[choice.variant]
        found.place[body.item] = place[number]
    return found


def start_values(ground: Ground, variables: Variables, known: Arrangement) -> dict[Any, float]:
    """Return the values that mean a known packing, reflected and with equal items in the program's order."""
    places = places_of(ground, known)
    values: dict[Any, float] = {}
    for number, body in enumerate(ground.bodies):
        build, variant, place = places[body.item]
        here = build >= 0 and variant in body.variants
        for b, inside in enumerate(variables.inside[number]):
            values[inside] = float(here and b == build)
        for v, turned in zip(body.variants, variables.turned[number], strict=False):
            values[turned] = float(here and v == variant)
        corner = np.clip(place, body.least, None) if here else body.least
        values |= dict(zip(variables.position[number], corner.tolist(), strict=True))
    for b, opened in enumerate(variables.opened):
        values[opened] = float(b <= known.build.max(initial=-1))
    holding = holding_directions(ground, lambda item: places[item])
    for held, directions in zip(holding, variables.direction, strict=True):
        values |= {v: 1.0 - h for v, h in zip(directions, held.tolist(), strict=True) if v is not None}
    return values


Place = tuple[int, int, Floats]
"""An item's build, variant and least corner."""


def places_of(ground: Ground, known: Arrangement) -> dict[int, Place]:
    """Return each item's place, reflected and with equal items swapped as `ip_symmetry` asks for."""
    places = {
        body.item: (int(known.build[body.item]), int(known.variant[body.item]), known.place[body.item])
        for body in ground.bodies
    }
    # a reflection along x turns the order round, so it comes first
    places = _in_order(ground, _reflected(ground, _in_order(ground, places), 0))
    for axis in (1,) if ground.scene.space.flat else (1, 2):
        places = _reflected(ground, places, axis)
    return places


def _in_order(ground: Ground, places: dict[int, Place]) -> dict[int, Place]:
    """Return the places with those of equal items sorted: used first, by build, from left to right."""
    found = dict(places)
    for run in ground.alike:
        items = [ground.bodies[ground.copies[rank][0]].item for rank in run]
        order = sorted(
            (places[i] for i in items), key=lambda place: (place[0] < 0, place[0], *place[2].tolist())
        )
        found |= dict(zip(items, order, strict=True))
    return found


def _reflected(ground: Ground, places: dict[int, Place], axis: int) -> dict[int, Place]:
    """Return the places, reflected along an axis in the first item's build if that is in the upper half."""
    first, space = ground.bodies[ground.copies[0][0]].item, ground.scene.space
    build, variant, place = places[first]
    if not ground.reflected or build < 0:
        return places
    ends = float(space.lo[axis] + space.hi[axis])
    if 2.0 * place[axis] + _length(ground, first, variant, axis) <= ends:
        return places
    found = dict(places)
    for item, (number, way, corner) in places.items():
        if number == build:
            mirrored = corner.copy()
            mirrored[axis] = ends - corner[axis] - _length(ground, item, way, axis)
            found[item] = (number, way, mirrored)
    return found


def _length(ground: Ground, item: int, variant: int, axis: int) -> float:
    """Return an item's length along an axis."""
    scene = ground.scene
    return float(scene.kinds[scene.kind[item]][variant].size[axis])


def holding_directions(ground: Ground, place_of: Callable[[int], Place]) -> list[Bools]:
    """Return per pair ``(6,)`` which directions hold; none when the pieces are not in one build."""
    return [_holding(ground, place_of, pair) for pair in ground.pairs]


def _holding(ground: Ground, place_of: Callable[[int], Place], pair: Pair) -> Bools:
    none = np.zeros(6, dtype=bool)
    boxes, build_of = [], []
    for piece in (pair.one, pair.other):
        if piece.body < 0:
            boxes.append((piece.least_lo, piece.least_hi))
            continue
        body = ground.bodies[piece.body]
        build, variant, place = place_of(body.item)
        if build < 0 or variant not in body.variants:
            return none
        own = body.variants.index(variant)
        boxes.append((place + body.lo[own, piece.box], place + body.hi[own, piece.box]))
        build_of.append(build)
    if len(build_of) == 2 and build_of[0] != build_of[1]:
        return none
    if len(build_of) == 1 and build_of[0] != 0 and not ground.obstacles[pair.other.box].everywhere:
        return none
    (lo, hi), (other_lo, other_hi) = boxes
    gap = pair.gap - ground.scene.space.slack
    return np.stack((hi + gap <= other_lo, other_hi + gap <= lo), axis=1).ravel() & pair.possible
