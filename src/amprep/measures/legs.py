"""Measure legs: stretches of support without a brace or a wall beside them."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.containment import inside
from amprep.geometry.supports.bends import without_bends
from amprep.geometry.supports.slabs import SlabPieces, pieces_of_slabs
from amprep.model import Build, Mesh, SupportBody

_OFFSET = 0.31
"""Height of a plane above a plane of the support grid, in slab thicknesses: cells end at the planes of the grid."""

_ROUNDING = 1e-5
"""Relative excess of a ratio that counts as rounding: files keep coordinates as float32."""


class MeasuredLeg(NamedTuple):
    """A leg, or the stretch of it that is narrowest for its length.

    Attributes
    ----------
    ratio
        Length divided by width.
    length_mm
        Length along the leg.
    width_mm
        Least width of the convex hull of its cross-section, where that is greatest.
    position_mm
        Middle of the stretch.
    """

    ratio: float
    length_mm: float
    width_mm: float
    position_mm: tuple[float, float, float]


class BodyLegs(NamedTuple):
    """The legs of one support body.

    Attributes
    ----------
    total
        Number of legs that are longer than wide.
    worst
        The leg with the greatest ratio of length to width; None if there is no leg.
    too_long
        The legs with a greater ratio than the limit, the worst first.
    """

    total: int
    worst: MeasuredLeg | None
    too_long: tuple[MeasuredLeg, ...]


def measure_legs(build: Build, thickness: float) -> tuple[BodyLegs, ...]:
    """Return the legs of each support body of a build.

    A body is cut by horizontal planes into slabs. A leg is a chain of pieces of neighbouring slabs, each with
    exactly one piece above and one below. It ends where pieces branch, at parts, and at the plate. A piece is as
    wide as its convex hull in plan. So windows in walls do not divide a leg, and neither do ends of struts in the
    air. A stretch of a leg is as wide as its widest piece, and the ratio of a leg is that of its worst stretch. Bends,
    whose hulls are wide in one or two slabs, do not count.

    Parameters
    ----------
    build
        Parts, supports, and the limit of the ratio in the rules.
    thickness
        Thickness of the slabs, mm: the height of a layer of the support grid.
    """
    limit = build.settings.rules.leg_ratio
    meshes = [placed.mesh for placed in build.parts]
    return tuple(
        legs_of(body.mesh, thickness, limit, [meshes[part] for part in body.parts])
        if _is_measured(body)
        else BodyLegs(0, None, ())
        for body in build.supports
    )


def _is_measured(body: SupportBody) -> bool:
    return not body.surface and len(body.mesh.triangles) > 0


def legs_of(mesh: Mesh, thickness: float, limit: float, parts: Sequence[Mesh] = ()) -> BodyLegs:
    """Return the legs of a solid.

    Parameters
    ----------
    mesh
        The solid.
    thickness
        Thickness of the slabs, mm.
    limit
        Largest ratio of length to width; 0 for none.
    parts
        The parts that the solid holds; ends inside of them divide a leg.
    """
    legs = sorted((leg for leg, _ in _measured_legs(mesh, thickness, parts)[1]), reverse=True)
    too_long = tuple(leg for leg in legs if 0.0 < limit * (1 + _ROUNDING) < leg.ratio)
    return BodyLegs(len(legs), legs[0] if legs else None, too_long)


def long_stretches(mesh: Mesh, thickness: float, limit: float, parts: Sequence[Mesh]) -> list[Floats]:
    """Return boxes ``(k, 2, 3)`` mm around the pieces of the stretches of legs with a greater ratio than a limit.

    Parameters
    ----------
    mesh, thickness, limit, parts
        As for `legs_of`.
    """
    pieces, legs = _measured_legs(mesh, thickness, parts)
    half = np.column_stack([pieces.size / 2, np.full(len(pieces.size), thickness / 2)])
    boxes = np.stack([pieces.centre - half, pieces.centre + half], axis=1)
    return [boxes[chain] for leg, chain in legs if leg.ratio > limit * (1 + _ROUNDING)]


def _measured_legs(
    mesh: Mesh, thickness: float, parts: Sequence[Mesh]
) -> tuple[SlabPieces, list[tuple[MeasuredLeg, list[int]]]]:
    """Return the pieces of a solid, and its legs, each with the pieces of its worst stretch."""
    vertices = mesh.vertices
    first = (_OFFSET + np.floor(vertices[:, 2].min() / thickness) - 1) * thickness
    pieces = pieces_of_slabs(vertices, mesh.triangles, first, thickness)
    pieces = _without_loose_ends(pieces, vertices, parts)
    return pieces, _measured(list(_chains(pieces)), pieces, thickness)


def _neighbours(pieces: SlabPieces) -> tuple[Int64s, Int64s]:
    """Return how many pieces are above each piece, and how many below."""
    upper, lower = pieces.link.T
    count = len(pieces.slab)
    return np.bincount(lower, minlength=count), np.bincount(upper, minlength=count)


def _without_loose_ends(pieces: SlabPieces, vertices: Floats, parts: Sequence[Mesh]) -> SlabPieces:
    """Drop the links to pieces that end beside others and touch no part."""
    above, _ = _neighbours(pieces)
    upper, lower = pieces.link.T
    loose = (above[upper] == 0) & (above[lower] > 1)
    if not loose.any():
        return pieces
    ends = np.flatnonzero(np.isin(pieces.piece, upper[loose]))
    touching = np.zeros(len(ends), np.bool_)
    for part in parts:
        touching |= inside(vertices[ends], part.vertices, part.triangles)
    held = np.isin(upper, pieces.piece[ends[touching]])
    return pieces._replace(link=pieces.link[~loose | held])


def _chains(pieces: SlabPieces) -> Iterator[list[int]]:
    """Yield the pieces of each leg downwards."""
    above, below = _neighbours(pieces)
    upper, lower = pieces.link.T
    inner: Bools = (above == 1) & (below == 1)
    down, up = np.full((2, len(inner)), -1)
    down[upper], up[lower] = lower, upper
    after, is_inner = down.tolist(), inner.tolist()
    for top in np.flatnonzero(inner & ~inner[up]).tolist():
        chain = [top]
        while is_inner[after[chain[-1]]]:
            chain.append(after[chain[-1]])
        yield chain


class _Stretch(NamedTuple):
    """A stretch of a leg: ratio, length and width (mm), the index of its first piece and the index after its last."""

    ratio: float
    length_mm: float
    width_mm: float
    first: int
    last: int


def _measured(
    chains: Sequence[Sequence[int]], pieces: SlabPieces, thickness: float
) -> list[tuple[MeasuredLeg, list[int]]]:
    """Return the worst stretch of each leg that is longer than wide, with its pieces."""
    begins = np.cumsum([0, *(len(chain) for chain in chains)])
    members = np.fromiter((piece for chain in chains for piece in chain), np.int64, int(begins[-1]))
    centres = np.vstack(
        [pieces.centre[members], np.zeros(3)]
    )  # with one row more, for sums up to the last one
    moved = np.diff(centres[:-1, :2], axis=0, prepend=0.0)
    moved[begins[:-1]] = 0.0
    lengths = np.hypot(thickness, np.minimum(np.hypot(*moved.T), thickness)).tolist()
    widths = pieces.width[members].tolist()
    found = []
    for begin, end in pairwise(begins.tolist()):
        worst = _worst_stretch(without_bends(widths[begin:end]), lengths[begin:end])
        if worst.ratio >= 1.0:
            found.append(worst._replace(first=begin + worst.first, last=begin + worst.last))
    ends = np.array([(each.first, each.last) for each in found], np.int64).reshape(-1, 2)
    sums = np.add.reduceat(centres, ends.ravel())[::2] if found else np.empty((0, 3))
    middles = (sums / np.diff(ends)).tolist()
    return [
        (
            MeasuredLeg(each.ratio, each.length_mm, each.width_mm, (x, y, z)),
            members[each.first : each.last].tolist(),
        )
        for each, (x, y, z) in zip(found, middles, strict=True)
    ]


def _worst_stretch(widths: Sequence[float], lengths: Sequence[float]) -> _Stretch:
    """Return the stretch of a leg with the greatest ratio of length to width.

    Strategy. The worst stretch with a given widest piece extends to the nearest wider pieces on both sides. A stack
    of pieces, each no wider than those below it, yields these for all pieces in linear time.
    """
    first, last = [0] * len(widths), [len(widths)] * len(widths)
    stack: list[int] = []
    for piece, width in enumerate(widths):
        while stack and widths[stack[-1]] < width:
            last[stack.pop()] = piece
        if stack:
            first[piece] = first[stack[-1]] if widths[stack[-1]] == width else stack[-1] + 1
        stack.append(piece)
    best = _Stretch(0.0, 0.0, 0.0, 0, 0)
    for piece in sorted(range(len(widths)), key=lambda piece: -widths[piece]):
        length = sum(lengths[first[piece] : last[piece]])
        if length / widths[piece] > best.ratio:
            best = _Stretch(length / widths[piece], length, widths[piece], first[piece], last[piece])
    return best
