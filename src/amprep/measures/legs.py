"""Measure legs: stretches of support without a brace or a wall beside them."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.containment import inside
from amprep.geometry.supports.bends import without_bends
from amprep.geometry.supports.slabs import SlabPieces, pieces_of_slabs
from amprep.model import Build, Mesh, SupportBody

_OFFSET = 0.31
"""Height of a plane above a plane of the support grid, in slab thicknesses: cells end at the planes of the grid."""


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
    vertices = mesh.vertices
    first = (_OFFSET + np.floor(vertices[:, 2].min() / thickness) - 1) * thickness
    pieces = pieces_of_slabs(vertices, mesh.triangles, first, thickness)
    pieces = _without_loose_ends(pieces, vertices, parts)
    measured = (_measured(chain, pieces, thickness) for chain in _chains(pieces))
    legs = sorted((leg for leg in measured if leg.ratio >= 1.0), reverse=True)
    too_long = tuple(leg for leg in legs if 0.0 < limit * (1 + 1e-9) < leg.ratio)
    return BodyLegs(len(legs), legs[0] if legs else None, too_long)


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


def _measured(chain: list[int], pieces: SlabPieces, thickness: float) -> MeasuredLeg:
    """Return the stretch of a leg with the greatest ratio of length to width."""
    widths = np.array(without_bends(pieces.width[chain].tolist()))
    centres = pieces.centre[chain]
    ends = np.diff(centres[:, :2], axis=0, prepend=centres[:1, :2])
    lengths = np.hypot(thickness, np.minimum(np.hypot(*ends.T), thickness))
    best = MeasuredLeg(0.0, 0.0, 0.0, (0.0, 0.0, 0.0))
    for width in np.unique(widths)[::-1]:
        if lengths.sum() / width <= best.ratio:
            continue
        for first, last in _runs(widths <= width):
            length = float(lengths[first:last].sum())
            if length / width > best.ratio:
                x, y, z = centres[first:last].mean(axis=0).tolist()
                best = MeasuredLeg(length / float(width), length, float(width), (x, y, z))
    return best


def _runs(chosen: Bools) -> Iterator[tuple[int, int]]:
    """Yield the first index and the index after the last of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(np.int8)))
    return zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
