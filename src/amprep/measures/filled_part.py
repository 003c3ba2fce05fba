"""Measure the powder trapped in a filled part."""

import numpy as np

from amprep.geometry.powder.pockets import Pocket, find_pockets
from amprep.model import Mesh

_LIFT = 1000.0
"""Height (mm) to which a part is lifted, so that the plate closes no opening."""


def pockets_of(mesh: Mesh, hole: float) -> tuple[Pocket, ...]:
    """Return the pockets of a solid that a ball of diameter `hole` mm cannot leave in any direction."""
    shift = np.array([0.0, 0.0, _LIFT - mesh.bounds[0][2]])
    return tuple(
        pocket._replace(
            point=_moved(pocket.point, -shift), lo=_moved(pocket.lo, -shift), hi=_moved(pocket.hi, -shift)
        )
        for pocket in find_pockets([(mesh.vertices + shift, mesh.triangles)], [], hole)
    )


def _moved(point: tuple[float, float, float], shift: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (np.array(point) + shift).tolist()
    return x, y, z
