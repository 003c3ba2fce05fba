"""Choose some of the overhang regions of a part, so that they are supported apart from the others."""

import numpy as np

from amprep.arrays import Bools
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
