"""Choose some of the overhang regions of a part, so that they are supported apart from the others."""

import numpy as np

from amprep.arrays import Bools, Floats
from amprep.overhangs.of_part import PartOverhangs


def select_regions(own: PartOverhangs, chosen: Bools, touchable: Bools) -> PartOverhangs:
    """Return the overhangs of a part with the faces, edges and tips of the chosen regions only.

    The regions keep their numbers.

    Parameters
    ----------
    own
        The overhangs of the part.
    chosen
        ``(r,)`` the regions that remain.
    touchable
        ``(r,)`` the regions to whose faces contacts may extend, where they are beside a chosen region.
    """
    found = own.overhangs
    faces, edges, tips = (chosen[each] for each in (found.face_region, found.edge_region, found.tip_region))
    beside = found.faces[~faces & touchable[found.face_region]]
    return own._replace(
        overhangs=found._replace(
            faces=found.faces[faces],
            face_region=found.face_region[faces],
            edges=found.edges[edges],
            edge_region=found.edge_region[edges],
            tips=found.tips[tips],
            tip_region=found.tip_region[tips],
            beside=np.concatenate([found.beside, beside]).astype(np.int32),
        )
    )


def measure_regions(own: PartOverhangs) -> PartOverhangs:
    """Return the overhangs of a part with the angle and the lowest height of each region measured.

    Parameters
    ----------
    own
        Overhangs that were found by the angle alone.
    """
    found, vertices, corners = own.overhangs, own.mesh.vertices, own.mesh.triangles
    count = len(found.regions)
    lowest, angle = np.full(count, np.inf), np.full(count, np.inf)
    faces, edges = vertices[corners[found.faces]], vertices[found.edges]
    np.minimum.at(lowest, found.face_region, faces[:, :, 2].min(axis=1, initial=np.inf))
    np.minimum.at(lowest, found.edge_region, edges[:, :, 2].min(axis=1, initial=np.inf))
    np.minimum.at(lowest, found.tip_region, vertices[found.tips, 2])
    np.minimum.at(angle, found.face_region, slopes_of(faces))
    along = edges[:, 1] - edges[:, 0]
    np.minimum.at(
        angle, found.edge_region, np.arctan2(np.abs(along[:, 2]), np.hypot(along[:, 0], along[:, 1]))
    )
    degrees = np.degrees(np.where(np.isfinite(angle), angle, 0.0))
    regions = tuple(
        each._replace(angle_deg=float(slope), lowest_mm=float(low))
        for each, slope, low in zip(found.regions, degrees, lowest, strict=True)
    )
    return own._replace(overhangs=found._replace(regions=regions))


def slopes_of(corners: Floats) -> Floats:
    """Return the angles (radians) of downward triangles ``(n, 3, 3)`` to the plate."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.arctan2(np.hypot(cross[:, 0], cross[:, 1]), -cross[:, 2]))
