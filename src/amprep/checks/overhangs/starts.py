"""Find where a part starts in the air: local minima of its solid above the plate."""

import numpy as np

from amprep.arrays import Bools, Int64s
from amprep.checks.overhangs.surface import LEVEL, MergedMesh, components


def plateaus(surface: MergedMesh) -> Int64s:
    """Label the points; points that level edges connect have the same label."""
    z = surface.points[:, 2]
    level = surface.ends[np.abs(np.diff(z[surface.ends], axis=1)[:, 0]) <= LEVEL]
    return components(level[:, 0], level[:, 1], len(z))


def starts_in_air(surface: MergedMesh, on_plate: float, dip: float = 0.0) -> Bools:
    """Tell at which points the part would start in the air: local minima with the solid above them, ``(n,)``.

    Parameters
    ----------
    surface
        The part.
    on_plate
        Height (mm) up to which points are on the plate.
    dip
        A minimum that is less than this below the saddle from which lower ground is reached is no start, mm.
    """
    z, plateau = surface.points[:, 2], plateaus(surface)
    rise = np.diff(z[surface.ends], axis=1)[:, 0]
    low = np.where(rise > 0, surface.ends[:, 1], surface.ends[:, 0])[np.abs(rise) > LEVEL]
    minimum = np.ones(int(plateau.max(initial=-1)) + 1, np.bool_)
    minimum[plateau[low]] = False
    minimum[plateau[z <= on_plate]] = False
    weight = np.zeros(len(minimum))
    corners = surface.points[surface.triangles]
    for i in range(3):
        a, b = (corners[:, (i + step) % 3] - corners[:, i] for step in (1, 2))
        between = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))
        np.add.at(weight, plateau[surface.triangles[:, i]], between * surface.normal[:, 2])
    starts = (minimum & (weight < 0))[plateau]
    return _without_dips(surface, np.asarray(starts), on_plate, dip) if dip > 0.0 else np.asarray(starts)


def _without_dips(surface: MergedMesh, starts: Bools, on_plate: float, dip: float) -> Bools:
    """Remove the starts from which a way along edges, nowhere higher than `dip` above them, leads to lower ground."""
    z = surface.points[:, 2]
    both = np.concatenate([surface.ends, surface.ends[:, ::-1]])
    order = np.argsort(both[:, 0], kind="stable")
    first = np.searchsorted(both[order, 0], np.arange(len(z) + 1))
    beside = both[order, 1]
    kept, known = starts.copy(), np.zeros(len(z), np.bool_)
    at_starts = np.flatnonzero(starts)
    for start in at_starts[np.argsort(z[at_starts], kind="stable")].tolist():
        if known[start]:
            continue
        lowest, ceiling = z[start] - LEVEL, z[start] + dip
        seen, todo, deep = {start}, [start], True
        while todo and deep:
            at = todo.pop()
            for other in beside[first[at] : first[at + 1]].tolist():
                if other not in seen and z[other] < ceiling:
                    seen.add(other)
                    todo.append(other)
                    deep = deep and z[other] >= lowest and z[other] > on_plate
        own = [point for point in seen if starts[point] and z[point] >= lowest]
        known[own] = True
        kept[own] = deep & (z[own] <= z[start] + LEVEL)
    return kept
