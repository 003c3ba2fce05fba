"""Is a mesh a solid? manifold3d judges; what may be mended without changing the shape is, and reported."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from amprep.geometry.merging import (
    Bools,
    Floats,
    Ints,
    compact,
    count_edges,
    degenerate,
    first_of_equal_rows,
    join_near,
    open_vertices,
    repeated,
)
from amprep.geometry.shells import find_inside_out, solid_volume

if TYPE_CHECKING:
    from manifold3d import Manifold

SEAM_TOLERANCE = 1e-3
"""mm; open edges closer than this may be sewn together, the distance at which the product counts contact."""

_FLOAT32_STEP = 2.0**-22  # of a coordinate: files keep float32, and exporters round once or twice


class Settled(NamedTuple):
    """A mesh that has been judged.

    Attributes
    ----------
    vertices, triangles
        ``(n, 3)`` float64 mm and ``(m, 3)`` int32: the mesh given, merged and turned where `notes` say so.
    volume
        mm3 where the winding number is positive; 0 when there is a problem.
    notes
        What was mended, a sentence each.
    problem
        Why manifold3d refuses it; empty for a solid.
    kept
        ``(m,)`` which of the triangles given each one is.
    turned
        ``(m,)`` whether its corners are in reverse order.
    """

    vertices: Floats
    triangles: NDArray[np.int32]
    volume: float
    notes: tuple[str, ...]
    problem: str
    kept: Ints
    turned: Bools


class _Candidate(NamedTuple):
    vertices: Floats
    triangles: Ints
    kept: Ints
    notes: tuple[str, ...]


def find_defect(vertices: ArrayLike, triangles: ArrayLike) -> str:
    """Say what keeps the arrays from being a mesh at all: nothing there, NaN, indices out of range; or ""."""
    points, corners = np.asarray(vertices, np.float64), np.asarray(triangles)
    if len(corners) == 0:
        return "it has no triangles"
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        return f"{(~finite).sum()} of {len(points)} vertices have NaN or infinite coordinates"
    outside = ((corners < 0) | (corners >= len(points))).any(axis=1)
    if outside.any():
        return f"{outside.sum()} of {len(corners)} triangles name a vertex that does not exist"
    if np.abs(points).max() > 1e12:
        return f"coordinates reach {np.abs(points).max():.3g} mm, too large to compute with"
    return ""


def settle(vertices: ArrayLike, triangles: ArrayLike) -> Settled:
    """Judge a mesh by manifold3d, mending only what leaves its shape as it is.

    Equal vertices are merged; degenerate and repeated triangles dropped; seams narrower than
    `SEAM_TOLERANCE` sewn if the mesh is not accepted otherwise; shells that are inside out turned. A mesh
    that manifold3d accepts without one of these steps is never refused for it.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)`` indices.
    """
    points = np.ascontiguousarray(vertices, np.float64).reshape(-1, 3)
    corners = np.ascontiguousarray(triangles, np.int64).reshape(-1, 3)
    defect = find_defect(points, corners)
    if defect:
        whole = np.arange(len(corners))
        return Settled(points, corners.astype(np.int32), 0.0, (), defect, whole, whole < 0)
    tidy = None
    for candidate in _candidates(points, corners):
        tidy = tidy or candidate
        if _accepted(candidate):
            return _oriented(candidate)
    assert tidy is not None  # noqa: S101 - the first candidate is always there
    return _refused(tidy)


def as_manifold(vertices: Floats, triangles: ArrayLike) -> "Manifold":
    """Hand a mesh to manifold3d, which takes no read-only arrays."""
    from manifold3d import Manifold, Mesh64

    return Manifold(Mesh64(np.array(vertices, order="C"), np.array(triangles, np.uint64, order="C")))


def _candidates(vertices: Floats, triangles: Ints) -> Iterator[_Candidate]:
    """Yield ways to read the mesh: tidied, tidied less, as it came, and last with its seams sewn."""
    merged = _tidied(vertices, triangles)
    unique = _without(merged, repeated(merged.triangles), "repeated triangle")
    yield unique
    yield merged
    yield _Candidate(vertices, triangles, np.arange(len(triangles)), ())
    float32_step = float(np.abs(vertices).max()) * _FLOAT32_STEP
    for tolerance in sorted({min(float32_step, SEAM_TOLERANCE), SEAM_TOLERANCE / 10, SEAM_TOLERANCE}):
        yield _sewn(unique, tolerance)


def _tidied(vertices: Floats, triangles: Ints) -> _Candidate:
    """Merge equal vertices and drop degenerate triangles."""
    first = first_of_equal_rows(vertices)
    merged = int((first != np.arange(len(vertices)))[np.unique(triangles)].sum())
    notes = (
        (f"merged {_count(merged, 'vertex', 'vertices')} with others at the same place",) if merged else ()
    )
    whole = _Candidate(vertices, first[triangles], np.arange(len(triangles)), notes)
    return _without(whole, degenerate(whole.triangles), "degenerate triangle")


def _without(mesh: _Candidate, dropped: Bools, what: str) -> _Candidate:
    """Drop triangles, and the vertices that only they used."""
    notes = mesh.notes
    if dropped.any():
        notes = (*notes, f"dropped {_count(int(dropped.sum()), what, what + 's')}")
    vertices, triangles = compact(mesh.vertices, mesh.triangles[~dropped])
    return _Candidate(vertices, triangles, mesh.kept[~dropped], notes)


def _sewn(mesh: _Candidate, tolerance: float) -> _Candidate:
    """Join vertices of open edges that lie within `tolerance` mm of one another."""
    source = join_near(mesh.vertices, open_vertices(mesh.triangles), tolerance)
    joined = _count(int((source != np.arange(len(source))).sum()), "vertex", "vertices")
    note = f"joined {joined} along open seams up to {tolerance:.2g} mm wide"
    whole = mesh._replace(triangles=source[mesh.triangles], notes=(*mesh.notes, note))
    return _without(whole, degenerate(whole.triangles), "degenerate triangle")


def _accepted(mesh: _Candidate) -> bool:
    from manifold3d import Error

    return len(mesh.triangles) > 0 and as_manifold(mesh.vertices, mesh.triangles).status() == Error.NoError


def _oriented(mesh: _Candidate) -> Settled:
    """Turn what is inside out, and measure."""
    turned, count, shells = find_inside_out(mesh.vertices, mesh.triangles)
    triangles = np.where(turned[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    notes = mesh.notes
    if count:
        notes = (*notes, _turning_note(bool(turned.all()), count, shells))
    volume = solid_volume(as_manifold(mesh.vertices, triangles))
    size = np.ptp(mesh.vertices, axis=0)
    if volume <= 1e-15 * float(np.linalg.norm(size)) ** 3:
        problem = "its volume is zero: it encloses nothing"
        return Settled(mesh.vertices, triangles.astype(np.int32), 0.0, notes, problem, mesh.kept, turned)
    return Settled(mesh.vertices, triangles.astype(np.int32), volume, notes, "", mesh.kept, turned)


def _turning_note(whole: bool, count: int, shells: int) -> str:
    if whole:
        return "the mesh was inside out: turned"
    return (
        f"{count} of {_count(shells, 'shell', 'shells')} {'were' if count > 1 else 'was'} inside out: turned"
    )


def _refused(mesh: _Candidate) -> Settled:
    untouched = np.zeros(len(mesh.triangles), np.bool_)
    problem = _describe_edges(mesh) if len(mesh.triangles) else "every triangle is without area"
    return Settled(
        mesh.vertices, mesh.triangles.astype(np.int32), 0.0, mesh.notes, problem, mesh.kept, untouched
    )


def _describe_edges(mesh: _Candidate) -> str:
    """Say in words which edges keep the mesh from being a solid, and where the first one is."""
    edges, uses, balance = count_edges(mesh.triangles)
    where = mesh.vertices[edges].mean(axis=1)
    odd, twisted = uses % 2 == 1, (uses % 2 == 0) & (balance != 0)
    if odd.any():
        what = "an odd number of triangles (a hole, or a wall that ends inside)"
        return f"{_edges(odd)} {what}, first near {_point(where[odd][0])}"
    if twisted.any():
        return f"{_edges(twisted)} triangles that face opposite ways, first near {_point(where[twisted][0])}"
    return "its volume is zero: every triangle is cancelled by an opposite one"


def _edges(chosen: Bools) -> str:
    number = int(chosen.sum())
    return f"{_count(number, 'edge borders', 'edges border')}"


def _point(point: Floats) -> str:
    return "({:.6g}, {:.6g}, {:.6g})".format(*point)


def _count(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"
