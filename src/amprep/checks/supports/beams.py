"""Judge beams: valid arrays, inside the build volume, not too deep in any part, connected to the plate."""

from collections.abc import Callable

import numpy as np

from amprep.arrays import CONTACT_TOLERANCE, Bools, Floats
from amprep.geometry.meshes.containment import inside
from amprep.geometry.supports.beams import (
    BeamSamples,
    balls_too_deep,
    find_grounded,
    near_surface,
    sample,
    sphere,
)
from amprep.model.build import Lattice
from amprep.model.build_volume import BuildVolume
from amprep.model.mesh import Mesh

_STEP = 0.4
"""Distance between the balls that are judged, in radii; it differs from the one that clips beams."""

_MOST_BALLS = 2_000_000
"""Number of balls, above which they are farther apart: of beams that are thousands of times as long as thick."""

_DIRECTIONS = sphere(42)


def fault_of(lattice: Lattice) -> str:
    """Return why the arrays are not valid beams, or an empty text."""
    nodes, struts, radii = lattice.nodes, lattice.struts, lattice.radii
    if not len(struts) or len(radii) != len(struts):
        return f"expected two radii for each beam, found {len(struts)} beams and {len(radii)} pairs of radii"
    if struts.min() < 0 or struts.max() >= len(nodes) or (struts[:, 0] == struts[:, 1]).any():
        return "a beam does not connect two of the nodes"
    if not np.isfinite(nodes).all():
        return "a node has non-finite coordinates"
    if not (np.isfinite(radii) & (radii > 0.0)).all():
        return "the radii of beams must be above 0"
    return ""


def excess_of(lattice: Lattice, space: BuildVolume) -> float:
    """Return the greatest distance of clipped beams outside the build volume, mm."""
    centres, radii = lattice.nodes[lattice.struts].reshape(-1, 3), lattice.radii.reshape(-1, 1)
    low, high = centres - radii, centres + radii
    if lattice.room is not None:
        low, high = np.maximum(low, lattice.room[0]), np.minimum(high, lattice.room[1])
    out = [float(-low[:, 2].min()), float((high - space.size)[:, 2].max())]
    if space.shape == "cylinder":
        middle = space.size[0] / 2
        out.append(float((np.hypot(*(centres[:, :2] - middle).T) + radii[:, 0] - middle).max()))
    else:
        out += [float(-low[:, :2].min()), float((high - space.size)[:, :2].max())]
    return max(out)


def enters_box(lattice: Lattice, lo: Floats, hi: Floats) -> bool:
    """Tell whether a beam enters a box."""
    places = _balls(lattice)
    away = np.maximum(np.maximum(lo - places.centres, places.centres - hi), 0.0)
    return bool((np.linalg.norm(away, axis=1) < places.radii - CONTACT_TOLERANCE).any())


def deepest_place(lattice: Lattice, mesh: Mesh, depth: float) -> Floats | None:
    """Return the centre ``(3,)`` of a ball of a beam that is more than `depth` mm deep in a solid, or None.

    Depth is measured vertically, on balls slightly smaller than the beam, so that contact does not count.
    """
    places = _balls(lattice)
    reach = np.maximum(places.radii - 2.0 * CONTACT_TOLERANCE, 0.0)
    triangles = mesh.triangles.astype(np.int64)
    deep = balls_too_deep(places.centres, reach, mesh.vertices, triangles, depth, _DIRECTIONS)
    return np.asarray(places.centres[deep][0]) if deep.any() else None


def count_floating(lattice: Lattice, rests: Callable[[Floats], Bools]) -> int:
    """Return the number of components of beams and solids that are not connected to the plate or to a part.

    Parameters
    ----------
    lattice
        Beams and the solids beside them.
    rests
        Function that tells which vertices of the solids rest on the plate or on a part.
    """
    solids = lattice.solids
    grounded = find_grounded(
        lattice.nodes,
        lattice.struts.astype(np.int64),
        lattice.radii,
        solids.vertices,
        solids.triangles.astype(np.int64),
        rests,
    )
    return grounded.floating


def _balls(lattice: Lattice) -> BeamSamples:
    """Return the balls along beams that are judged."""
    ends = lattice.nodes[lattice.struts]
    length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    count = float((length / (_STEP * lattice.radii.min(axis=1))).sum())
    step = _STEP * max(1.0, count / _MOST_BALLS)
    return sample(lattice.nodes, lattice.struts.astype(np.int64), lattice.radii, step)


def contacts_of(lattice: Lattice, mesh: Mesh, nudge: float) -> Floats:
    """Return points ``(k, 3)`` on the surface of beams that are in a solid, or at most `nudge` mm below it."""
    places = _balls(lattice)
    arrays = mesh.arrays
    near = near_surface(places.centres, float(places.radii.max(initial=0.0)) + nudge, *arrays)
    directions = np.vstack([_DIRECTIONS, (0.0, 0.0, 1.0)])
    points = (places.centres[near, None] + places.radii[near, None, None] * directions).reshape(-1, 3)
    if lattice.room is not None:
        low, high = lattice.room[0] - CONTACT_TOLERANCE, lattice.room[1] + CONTACT_TOLERANCE
        points = points[((points >= low) & (points <= high)).all(axis=1)]
    return np.asarray(points[inside(points + (0.0, 0.0, nudge), mesh.vertices, mesh.triangles)])


def thinnest_of(lattice: Lattice) -> tuple[float, Floats]:
    """Return the diameter (mm) of the thinnest end of a beam, and its place ``(3,)``."""
    beam, end = np.unravel_index(lattice.radii.argmin(), lattice.radii.shape)
    return 2.0 * float(lattice.radii[beam, end]), np.asarray(lattice.nodes[lattice.struts[beam, end]])
