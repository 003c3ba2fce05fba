"""Validate meshes by manifold3d and repair defects that can be repaired without changing the shape."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.meshes.manifold import accepted, as_manifold
from amprep.geometry.meshes.shells import MAX_UNITED, find_inside_out, measure_shells, solid_volume
from amprep.geometry.meshes.topology import (
    count_edges,
    degenerate,
    drop_unused_vertices,
    first_of_equal_rows,
    join_near,
    open_vertices,
    repeated,
)

if TYPE_CHECKING:
    pass

SEAM_TOLERANCE = 1e-3
"""Largest width (mm) of an open seam that is closed; equal to the contact tolerance."""

_FLOAT32_STEP = 2.0**-22
"""Rounding error of a coordinate, relative: files store float32, and exporters may round twice."""


class RepairedMesh(NamedTuple):
    """Result of validation and repair.

    Attributes
    ----------
    vertices, triangles
        ``(n, 3)`` float64 mm and ``(m, 3)`` int32, the repaired mesh.
    volume
        Volume where the winding number is positive, mm3; 0 if the mesh is not a solid.
    notes
        One sentence for each kind of repair.
    problem
        Reason why the mesh is not a solid; empty for a solid.
    kept
        ``(m,)`` index of the input triangle of each triangle.
    turned
        ``(m,)`` whether the orientation of the triangle was reversed.
    """

    vertices: Floats
    triangles: NDArray[np.int32]
    volume: float
    notes: tuple[str, ...]
    problem: str
    kept: Int64s
    turned: Bools


class _Candidate(NamedTuple):
    vertices: Floats
    triangles: Int64s
    kept: Int64s
    notes: tuple[str, ...]


def find_defect(vertices: ArrayLike, triangles: ArrayLike) -> str:
    """Return why arrays are not a mesh (no triangles, NaN, indices out of range), or an empty text."""
    points, corners = np.asarray(vertices, np.float64), np.asarray(triangles)
    if len(corners) == 0:
        return "it has no triangles"
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        return f"{(~finite).sum()} of {len(points)} vertices have NaN or infinite coordinates"
    outside = ((corners < 0) | (corners >= len(points))).any(axis=1)
    if outside.any():
        return f"{outside.sum()} of {len(corners)} triangles refer to a vertex that does not exist"
    if np.abs(points).max() > 1e12:
        return f"coordinates reach {np.abs(points).max():.3g} mm, too large to compute with"
    return ""


def repair_mesh(vertices: ArrayLike, triangles: ArrayLike) -> RepairedMesh:
    """Validate a mesh by manifold3d and repair it without changing its shape.

    Repairs merge equal vertices, drop degenerate and repeated triangles, close seams narrower than `SEAM_TOLERANCE` if
    the mesh is not accepted otherwise, and turn shells that are inside out. A mesh that manifold3d accepts without one
    of these repairs is never rejected because of it.

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
        return RepairedMesh(points, corners.astype(np.int32), 0.0, (), defect, whole, whole < 0)
    found: list[RepairedMesh] = []
    for candidate in _candidates(points, corners):
        volume = _accepted_volume(candidate)
        if volume is not None:
            found.append(_oriented(candidate))
            if not found[-1].problem and _faithful(volume, candidate):
                return found[-1]
    solids = [repaired for repaired in found if not repaired.problem]
    return (solids or found or [_rejected(_cleaned(points, corners))])[0]


def _candidates(vertices: Floats, triangles: Int64s) -> Iterator[_Candidate]:
    """Yield candidates in the order of preference: cleaned, unchanged, and with closed seams."""
    merged = _cleaned(vertices, triangles)
    unique = _without(merged, repeated(merged.triangles), "repeated triangle")
    if len(unique.triangles) < len(merged.triangles) and _same_solid(unique, merged):
        yield unique
    yield merged
    yield _Candidate(vertices, triangles, np.arange(len(triangles)), ())
    yield unique
    yield from _seams_closed(unique)


def _accepted_volume(mesh: _Candidate) -> float | None:
    """Return the volume that manifold3d measures, None if it rejects the mesh; its solid is large and not kept."""
    solid = as_manifold(mesh.vertices, mesh.triangles)
    return solid.volume() if accepted(solid) else None


def _same_solid(one: _Candidate, other: _Candidate) -> bool:
    """Tell whether two candidates have the same volume, as they do if only whole shells are repeated."""
    if any(_accepted_volume(mesh) is None for mesh in (one, other)):
        return False
    return bool(np.isclose(_oriented(one).volume, _oriented(other).volume, rtol=1e-9))


def _cleaned(vertices: Floats, triangles: Int64s) -> _Candidate:
    """Merge equal vertices and drop degenerate triangles."""
    first = first_of_equal_rows(vertices)
    used = np.zeros(len(vertices), np.bool_)
    used[triangles] = True
    merged = int((used & (first != np.arange(len(vertices)))).sum())
    notes = (
        (f"merged {_count(merged, 'vertex', 'vertices')} with others at the same place",) if merged else ()
    )
    whole = _Candidate(vertices, first[triangles], np.arange(len(triangles)), notes)
    return _without(whole, degenerate(whole.triangles), "degenerate triangle")


def _without(mesh: _Candidate, dropped: Bools, what: str) -> _Candidate:
    """Drop triangles and the vertices that only they use."""
    notes = mesh.notes
    if dropped.any():
        notes = (*notes, f"dropped {_count(int(dropped.sum()), what, what + 's')}")
    vertices, triangles = drop_unused_vertices(mesh.vertices, mesh.triangles[~dropped])
    return _Candidate(vertices, triangles, mesh.kept[~dropped], notes)


def _seams_closed(mesh: _Candidate) -> Iterator[_Candidate]:
    """Yield candidates with joined vertices of open edges, for increasing tolerances."""
    float32_step = min(float(np.abs(mesh.vertices).max(initial=0.0)) * _FLOAT32_STEP, SEAM_TOLERANCE)
    loose = open_vertices(mesh.triangles)
    for tolerance in sorted({float32_step, SEAM_TOLERANCE / 10, SEAM_TOLERANCE}):
        source = join_near(mesh.vertices, loose, tolerance)
        joined = int((source != np.arange(len(source))).sum())
        if joined:
            number = _count(joined, "vertex", "vertices")
            note = f"joined {number} along open seams up to {tolerance:.2g} mm wide"
            whole = mesh._replace(triangles=source[mesh.triangles], notes=(*mesh.notes, note))
            yield _without(whole, degenerate(whole.triangles), "degenerate triangle")


def _faithful(volume: float, mesh: _Candidate) -> bool:
    """Tell whether the volume that manifold3d measures is the one that the triangles enclose.

    At edges of more than two triangles it may pair triangles so that too many cancel; another candidate may be better.
    """
    corners = mesh.vertices[mesh.triangles] - mesh.vertices[0]
    enclosed = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0
    size = float(np.prod(np.ptp(mesh.vertices, axis=0)))
    return bool(abs(volume - enclosed) <= 1e-6 * abs(enclosed) + 1e-9 * size)


def _oriented(mesh: _Candidate) -> RepairedMesh:
    """Turn shells that are inside out and measure the volume; turn nothing if the volume would be zero then."""
    shells = measure_shells(mesh.vertices, mesh.triangles)
    if shells.may_overlap.sum() > MAX_UNITED:
        note = f"more than {MAX_UNITED} shells that may overlap: the volume counts overlaps repeatedly"
        mesh = mesh._replace(notes=(*mesh.notes, note))
    turn, outer = find_inside_out(shells)
    if outer:
        turned = turn[shells.label]
        triangles = np.where(turned[:, None], mesh.triangles[:, ::-1], mesh.triangles)
        right = shells._replace(volume=np.where(turn, -shells.volume, shells.volume))
        volume = solid_volume(mesh.vertices, triangles, right)
        if volume > _least_volume(mesh):
            note = _turning_note(bool(turn.all()), outer, len(turn))
            return _finished(
                mesh._replace(triangles=triangles, notes=(*mesh.notes, note)), volume, "", turned
            )
    volume = solid_volume(mesh.vertices, mesh.triangles, shells)
    problem = "" if volume > _least_volume(mesh) else "its volume is zero"
    return _finished(mesh, volume, problem, np.zeros(len(mesh.triangles), np.bool_))


def _finished(mesh: _Candidate, volume: float, problem: str, turned: Bools) -> RepairedMesh:
    triangles = mesh.triangles.astype(np.int32)
    measured = 0.0 if problem else volume
    return RepairedMesh(mesh.vertices, triangles, measured, mesh.notes, problem, mesh.kept, turned)


def _least_volume(mesh: _Candidate) -> float:
    """Return the error that rounding causes in a volume of zero, mm3."""
    return 1e-15 * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))) ** 3


def _turning_note(whole: bool, count: int, shells: int) -> str:
    if whole:
        return "the mesh was inside out: reversed"
    return f"{count} of {_count(shells, 'shell', 'shells')} {'were' if count > 1 else 'was'} inside out: reversed"


def _rejected(mesh: _Candidate) -> RepairedMesh:
    problem = _describe_edges(mesh) if len(mesh.triangles) else "every triangle has zero area"
    return _finished(mesh, 0.0, problem, np.zeros(len(mesh.triangles), np.bool_))


def _describe_edges(mesh: _Candidate) -> str:
    """Describe the edges that prevent the mesh from being a solid, with the position of the first."""
    edges, uses, balance = count_edges(mesh.triangles)
    where = mesh.vertices[edges].mean(axis=1)
    odd, twisted = uses % 2 == 1, (uses % 2 == 0) & (balance != 0)
    if odd.any():
        what = "an odd number of triangles (a hole, or an internal wall)"
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
