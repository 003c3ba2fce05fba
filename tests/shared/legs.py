"""Legs of finished solids by slices of manifold3d: an oracle that shares no code with the planner or the measure."""

import numpy as np
from manifold3d import CrossSection


def least_width(polygons):
    """Least width of the convex hull of polygons: the least over the directions of its sides."""
    hull = np.concatenate(CrossSection.batch_hull(polygons).to_polygons())
    side = np.roll(hull, -1, axis=0) - hull
    side = side[np.hypot(*side.T) > 1e-9]
    across = np.column_stack([-side[:, 1], side[:, 0]]) / np.hypot(*side.T)[:, None]
    return float(np.ptp(hull @ across.T, axis=0).min())


def slices_of(solid, heights):
    """The pieces of each horizontal cross-section."""
    return [solid.slice(float(height)).decompose() for height in heights]


def sliced_legs(solid, heights, *, contacts=()):
    """Ratio of length to width of every chain of pieces with exactly one piece above and one below.

    Parameters
    ----------
    solid
        The solid as a `Manifold`.
    heights
        Heights of the slices, equally far apart.
    contacts
        Boxes (low, high) in which a part holds the solid; a piece in one ends a leg.
    """
    slices = slices_of(solid, heights)
    links = [
        [(i, j) for i, a in enumerate(low) for j, b in enumerate(high) if not (a ^ b).is_empty()]
        for low, high in zip(slices, slices[1:], strict=False)
    ]
    inner = {}
    for level, pieces in enumerate(slices):
        for number, piece in enumerate(pieces):
            above = [j for i, j in links[level] if i == number] if level < len(links) else []
            below = [i for i, j in links[level - 1] if j == number] if level else []
            held = any(_is_inside(piece, heights[level], box) for box in contacts)
            if len(above) == 1 and len(below) == 1 and not held:
                inner[level, number] = (level + 1, above[0])
    tops = set(inner.values())
    ratios = []
    for start in sorted(set(inner) - tops):
        chain, here = [], start
        while here in inner:
            chain.append(slices[here[0]][here[1]])
            here = inner[here]
        length = len(chain) * (heights[1] - heights[0])
        ratios.append(length / least_width(chain))
    return ratios


def _is_inside(piece, height, box):
    (low, high), bounds = box, piece.bounds()
    apart = bounds[0] > high[0] or bounds[2] < low[0] or bounds[1] > high[1] or bounds[3] < low[1]
    return not apart and low[2] <= height <= high[2]
