"""Summarise overhang regions where limits apply."""

from typing import Any

import numpy as np

from amprep.arrays import Bools, Floats, Int64s
from amprep.geometry.overhangs.candidates import Candidates
from amprep.geometry.overhangs.carried.sizes import RegionSize
from amprep.geometry.overhangs.regions import OverhangRegion, components_of_faces, numbered_by_first
from amprep.geometry.overhangs.surface import Surface

_UNSIZED = RegionSize("face", 0.0, 0.0)
"""Size of regions of enforced faces only."""


def face_regions(
    corners: Floats, region: Int64s, sizes: dict[int, RegionSize], holds: Bools, starts: Bools
) -> list[OverhangRegion]:
    """Return regions of faces.

    Parameters
    ----------
    corners, region
        ``(k, 3, 3)`` mm: triangles that need support, or all where the part carries the region; and their numbers.
    sizes
        Kind and size of each region that has any.
    holds, starts
        ``(n,)`` whether the part carries the region, and whether it starts in the air there.
    """
    found = []
    for number, figures in enumerate(_figures(corners, region, len(holds))):
        kind, size, limit = sizes.get(number, _UNSIZED)
        found.append(
            OverhangRegion(
                kind,
                size_mm=round(size, 6),
                limit_mm=limit,
                starts_in_air=bool(starts[number]),
                is_self_supporting=bool(holds[number]),
                **figures,
            )
        )
    return found


def noncritical_regions(surface: Surface, spared: Bools) -> list[OverhangRegion]:
    """Return regions of the faces ``(m,)`` between the overhang angle and the noncritical angle."""
    label = numbered_by_first(components_of_faces(surface, spared))
    corners = surface.points[surface.triangles[spared]]
    return [
        OverhangRegion("face", is_self_supporting=True, is_noncritical=True, **figures)
        for figures in _figures(corners, label, int(label.max(initial=-1)) + 1)
    ]


def tip_regions(found: Candidates) -> tuple[Int64s, list[OverhangRegion]]:
    """Return the number of the region of each tip, from 0, and the regions."""
    number = numbered_by_first(found.tip_label)
    points = found.surface.points[found.tips]
    regions = []
    for each in range(int(number.max(initial=-1)) + 1):
        own = points[number == each]
        regions.append(
            OverhangRegion("tip", 0.0, own.mean(axis=0), starts_in_air=True, lowest_mm=float(own[:, 2].min()))
        )
    return number, regions


def _figures(corners: Floats, region: Int64s, count: int) -> list[dict[str, Any]]:
    """Return area, centre, smallest angle and lowest height of each region of triangles."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    total = np.bincount(region, weights=area, minlength=count)
    middle = corners.mean(axis=1).reshape(-1, 3)
    share = area / np.maximum(total[region], 1e-300)
    centre = np.column_stack(
        [np.bincount(region, weights=share * middle[:, i], minlength=count) for i in range(3)]
    )
    flattest = np.zeros(count)
    np.maximum.at(flattest, region, np.abs(cross[:, 2]) / np.maximum(2 * area, 1e-300))
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, region, corners[:, :, 2].min(axis=1, initial=np.inf))
    angle = np.degrees(np.arccos(np.clip(flattest, 0.0, 1.0)))
    return [
        {"measure": float(a), "centre": c, "angle_deg": float(g), "lowest_mm": float(z)}
        for a, c, g, z in zip(total, centre, angle, lowest, strict=True)
    ]
