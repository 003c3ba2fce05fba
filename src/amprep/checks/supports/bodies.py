"""Judge finished supports: closed, inside the build volume, standing on the plate, not too deep in any part."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.checks.packing.parts_placed import TOLERANCE
from amprep.checks.supports import beams
from amprep.checks.supports.solids import KnownSolids
from amprep.checks.violation import Violation, place_words
from amprep.geometry.meshes.containment import inside
from amprep.geometry.meshes.manifold import as_manifold
from amprep.geometry.meshes.shells import label_shells
from amprep.geometry.meshes.topology import merge_equal_vertices
from amprep.model.build import Build, BuildSettings, Lattice, PlacedPart, SupportBody
from amprep.model.build_volume import BuildVolume
from amprep.model.control import Stop
from amprep.model.counting import counted

if TYPE_CHECKING:
    from manifold3d import Manifold

CLOSED = "support is closed"
INSIDE = "support inside build volume"
STANDING = "support stands on the plate"
PENETRATION = "support enters no part"

NEGLIGIBLE_VOLUME = 1e-4
"""Volume (mm3) of the slivers that Booleans leave: rounding of coordinates (1e-5 mm) times about 10 mm2."""


class JudgedBody:
    """A support body with its solid, which is made when it is first needed."""

    def __init__(self, support: SupportBody, solids: KnownSolids) -> None:
        self.support, self.solids = support, solids
        self.name = support.name

    @property
    def solid(self) -> "Manifold":
        """The body as a solid."""
        return self.solids.of(self.support.mesh)


def check_bodies(build: Build, stop: Stop, solids: KnownSolids | None = None) -> list[Violation]:
    """Return the broken promises of the supports of a build.

    Solids are judged exactly, by manifold3d. Walls without thickness are judged at their corners and at the centres of
    triangles and edges, beams at points on balls along them. `solids` are shared with other judges.
    """
    found: list[Violation] = []
    solids = solids or KnownSolids()
    boxes = [placed.mesh.bounds for placed in build.parts]
    low, high = (np.array([box[side] for box in boxes]).reshape(-1, 3) for side in (0, 1))
    for support in build.supports:
        beside = None if support.lattice is None else support.lattice.solids
        body = JudgedBody(support if beside is None else replace(support, mesh=beside), solids)
        faults = _unsound(support, solids) if support.lattice else _closed(body)
        found += faults
        if faults:
            continue
        found += [*_inside(body, build.settings.space), *_standing(body, build)]
        for index in np.flatnonzero(_may_enter(body, low, high)).tolist():
            if stop():
                return found
            found += _penetration(body, build.parts[index], build.settings, holds=index in body.support.parts)
    return found


def _closed(body: JudgedBody) -> list[Violation]:
    """Judge whether a body is a solid; a surface must only be finite."""
    mesh = body.support.mesh
    if len(mesh.triangles) == 0 or not np.isfinite(mesh.vertices).all():
        return [Violation(CLOSED, body.name, "expected a finite mesh with triangles, found none")]
    if body.support.surface:
        return []
    status, volume = body.solid.status().name, body.solid.volume()
    if status == "NoError" and volume > 0:
        return []
    return [Violation(CLOSED, body.name, f"expected a solid, manifold3d says {status} and {volume:.3g} mm3")]


def _unsound(support: SupportBody, solids: KnownSolids) -> list[Violation]:
    """Judge the arrays of beams, the solids beside them, and the mesh for readers without beams."""
    if support.lattice is None:
        return []
    fault = beams.fault_of(support.lattice)
    found = [Violation(CLOSED, support.name, fault)] if fault else []
    for mesh in (support.lattice.solids, support.lattice.stand_in):
        if len(mesh.triangles):
            found += _closed(JudgedBody(replace(support, mesh=mesh, lattice=None), solids))
    return found


def _inside(body: JudgedBody, space: BuildVolume) -> list[Violation]:
    lattice = body.support.lattice
    excess = -np.inf if lattice is None else beams.excess_of(lattice, space)
    if len(body.support.mesh.vertices):
        excess = max(excess, _excess(body.support.mesh.vertices, space))
    found = []
    if excess > TOLERANCE:
        found.append(Violation(INSIDE, body.name, f"sticks out of the build volume by {excess:.4f} mm"))
    return [*found, *_zones(body, space)]


def _excess(points: Floats, space: BuildVolume) -> float:
    """Return the greatest distance of points outside the build volume, mm."""
    below, above = -points.min(axis=0), points.max(axis=0) - space.size
    if space.shape == "cylinder":
        radius = space.size[0] / 2
        above[:2] = below[:2] = np.hypot(*(points[:, :2] - radius).T).max() - radius
    return float(max(below.max(), above.max()))


def _zones(body: JudgedBody, space: BuildVolume) -> list[Violation]:
    found = []
    for lo, hi in zip(space.zone_lo + TOLERANCE, space.zone_hi - TOLERANCE, strict=True):
        lattice = body.support.lattice
        if _volume_in_box(body, lo, hi) or (lattice is not None and beams.enters_box(lattice, lo, hi)):
            found.append(
                Violation(INSIDE, body.name, f"reaches into the forbidden zone at {place_words(lo)} mm")
            )
    return found


def _volume_in_box(body: JudgedBody, lo: Floats, hi: Floats) -> bool:
    from manifold3d import Manifold

    corners = body.support.mesh.vertices[body.support.mesh.triangles]
    near = ((corners.max(axis=1) > lo) & (corners.min(axis=1) < hi)).all(axis=1)
    if body.support.surface or not near.any():
        return bool(near.any())
    common = body.solid ^ Manifold.cube((hi - lo).tolist()).translate(lo.tolist())
    return bool(common.volume() > NEGLIGIBLE_VOLUME)


def _standing(body: JudgedBody, build: Build) -> list[Violation]:
    """Judge whether every disconnected component reaches the plate; components that share a point are connected.

    A shell of negative volume bounds a void and is not a component. Where the build allows it, a component may stand on
    a part that the body holds instead.
    """
    if body.support.lattice is not None:
        return _standing_beams(body, body.support.lattice, build)
    if _all_reach_plate(body):
        return []
    points, triangles = merge_equal_vertices(
        np.round(body.support.mesh.vertices, 4), body.support.mesh.triangles
    )
    count, shell = label_shells(triangles, len(points))
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, shell, points[triangles, 2].min(axis=1))
    if not body.support.surface:
        a, b, c = (points[triangles[:, i]] - points[triangles[:, 0]].mean(axis=0) for i in range(3))
        volume = np.bincount(shell, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0, count)
        lowest[volume <= NEGLIGIBLE_VOLUME] = 0.0
    if build.settings.rules.grounding == "anywhere" and (lowest > TOLERANCE).any():
        held = [build.parts[index] for index in body.support.parts]
        in_air = np.unique(triangles[lowest[shell] > TOLERANCE])
        on_part = np.zeros(len(points), np.bool_)
        on_part[in_air] = _rest_on(points[in_air], held, build.settings.overlap)
        lowest[shell[on_part[triangles].any(axis=1)]] = 0.0
    floating = int((lowest > TOLERANCE).sum())
    if not floating:
        return []
    first = points[triangles[shell == int(lowest.argmax())][0, 0]]
    place = place_words(first)
    message = f"floats: {floating} of {counted(count, 'component')} not on the plate, one at {place} mm"
    return [Violation(STANDING, body.name, message)]


def _all_reach_plate(body: JudgedBody) -> bool:
    """Tell whether every component reaches the plate even if none of those that share a point are connected."""
    mesh = body.support.mesh
    used, shell = body.solids.shells_of(mesh)
    lowest = np.full(used, np.inf)
    np.minimum.at(lowest, shell, mesh.vertices[:, 2][mesh.triangles].min(axis=1))
    return bool((lowest <= TOLERANCE).all())


def _standing_beams(body: JudgedBody, lattice: Lattice, build: Build) -> list[Violation]:
    """Judge whether beams and the solids that touch them are connected to the plate."""

    def rests(points: Floats) -> Bools:
        on_plate = points[:, 2] <= TOLERANCE
        if build.settings.rules.grounding == "anywhere":
            held = [build.parts[index] for index in body.support.parts]
            on_plate |= _rest_on(points, held, build.settings.overlap)
        return np.asarray(on_plate)

    floating = beams.count_floating(lattice, rests)
    message = f"floats: {counted(floating, 'component')} of beams and solids not on the plate"
    return [Violation(STANDING, body.name, message)] if floating else []


def _rest_on(points: Floats, parts: Sequence[PlacedPart], overlap: float) -> Bools:
    """Tell which points are at or slightly below an upper surface of a part: inside it, and outside a little higher."""
    found = np.zeros(len(points), np.bool_)
    for placed in parts:
        mesh = placed.mesh
        below = inside(points - (0.0, 0.0, TOLERANCE), mesh.vertices, mesh.triangles)
        above = inside(points + (0.0, 0.0, overlap + 2 * TOLERANCE), mesh.vertices, mesh.triangles)
        found |= below & ~above
    return found


def _may_enter(body: JudgedBody, low: Floats, high: Floats) -> Bools:
    """Tell the boxes of which parts a body meets; beams may meet any."""
    mesh = body.support.mesh
    if body.support.lattice is not None:
        return np.ones(len(low), np.bool_)
    return np.asarray(((mesh.bounds[0] <= high) & (mesh.bounds[1] >= low)).all(axis=1))


def _penetration(
    body: JudgedBody, placed: PlacedPart, settings: BuildSettings, *, holds: bool
) -> list[Violation]:
    """Judge the depth of a body in one part.

    A part that the body holds may be entered from below by the overlap, and from above where supports may stand on
    parts. Other parts must not be entered.
    """
    feet = holds and settings.rules.grounding == "anywhere"
    depth = (settings.overlap if holds else 0.0) + TOLERANCE
    if not placed.part.is_solid:
        return []
    lattice = body.support.lattice
    place = None if lattice is None else beams.deepest_place(lattice, placed.mesh, depth)
    if place is not None:
        message = f"enters {placed.label}: a beam at {place_words(place)} mm is more than {depth:.4g} mm deep"
        return [Violation(PENETRATION, body.name, message)]
    if not len(body.support.mesh.triangles):
        return []
    (lo, hi), (part_lo, part_hi) = body.support.mesh.bounds, placed.mesh.bounds
    if ((lo > part_hi) | (hi < part_lo)).any():
        return []
    if body.support.surface:
        deep = _sheet_enters(body, placed, depth)
        found = f"a wall is more than {depth:.4g} mm deep" if deep else ""
    else:
        volume = _volume_deeper(body, placed, depth, feet=feet)
        found = f"{volume:.3g} mm3 are more than {depth:.4g} mm deep" if volume > NEGLIGIBLE_VOLUME else ""
    return [Violation(PENETRATION, body.name, f"enters {placed.label}: {found}")] if found else []


def _volume_deeper(body: JudgedBody, placed: PlacedPart, depth: float, *, feet: bool) -> float:
    """Return the volume of the points that are in body and part together with the point `depth` below them.

    With `feet`, the point `depth` above them must be in the part too.
    """
    part = as_manifold(placed.mesh.vertices, placed.mesh.triangles)
    below = body.solid ^ part.translate((0.0, 0.0, depth))
    if below.is_empty() or below.volume() <= NEGLIGIBLE_VOLUME:
        return 0.0
    if feet:
        below ^= part.translate((0.0, 0.0, -depth))
    return float(sum(piece.volume() for piece in (below ^ part).decompose() if _thickness(piece) > TOLERANCE))


def _thickness(solid: "Manifold") -> float:
    """Return the mean thickness of a flat piece, mm; contact along a steep wall is deep but thin."""
    return float(2.0 * solid.volume() / max(solid.surface_area(), NEGLIGIBLE_VOLUME))


def _sheet_enters(body: JudgedBody, placed: PlacedPart, depth: float) -> bool:
    """Tell whether a corner or centre of a surface is in the part together with the point `depth` below it.

    Horizontally it must be deeper than contact.
    """
    corners = body.support.mesh.vertices[body.support.mesh.triangles]
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    points = np.concatenate([corners.reshape(-1, 3), middles.reshape(-1, 3), corners.mean(axis=1)])
    mesh, side = placed.mesh, 2 * TOLERANCE
    for dx, dy in ((0.0, 0.0), (side, 0.0), (-side, 0.0), (0.0, side), (0.0, -side)):
        for dz in (0.0, -depth):
            points = points[inside(points + (dx, dy, dz), mesh.vertices, mesh.triangles)]
    return len(points) > 0
