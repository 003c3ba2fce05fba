"""The mesh of the part itself as its bounding volume (thesis 2.6)."""

import numpy as np

from amprep.errors import MeshError
from amprep.hookspecs import NoParams
from amprep.model.bounding_volume import Solid
from amprep.model.control import Stop
from amprep.model.part import Part


def own_mesh(part: Part, *, params: NoParams, rng: np.random.Generator, stop: Stop) -> Solid:  # noqa: ARG001
    """Return the mesh of the part.

    Raises
    ------
    MeshError
        If the part is not a solid.
    """
    if not part.is_solid:
        raise MeshError(
            f"part {part.name!r}: the volume maker 'mesh' needs a solid, but the mesh is open; repair it or choose "
            "the volume maker 'box' for it"
        )
    return Solid(part.mesh)
