"""The arrays of a model's objects, by the ids that the file states."""

from typing import TYPE_CHECKING

import numpy as np

from amprep.arrays import Bools, Floats, MeshArrays
from amprep.checks.printed.found import PrintedBeams
from amprep.model.mesh import Mesh
from amprep.threemf.read.arrays import fetch_capped_beams, fetch_geometry

if TYPE_CHECKING:
    from lib3mf import Lib3MF


class ObjectMeshes:
    """Fetches the mesh of an object when it is first needed."""

    def __init__(self, model: "Lib3MF.Model") -> None:
        self._model = model
        self._objects: dict[int, Lib3MF.MeshObject] = {}
        found = model.GetMeshObjects()
        while found.MoveNext():
            mesh = found.GetCurrentMeshObject()
            self._objects[mesh.GetModelResourceID()] = mesh
        self._known: dict[int, MeshArrays] = {}

    def of(self, object_id: int) -> MeshArrays:
        """Return vertices ``(n, 3)`` in the file's unit, and triangles ``(m, 3)``.

        Raises
        ------
        ValueError
            If the object has no mesh.
        """
        if object_id not in self._objects:
            raise ValueError(f"the build refers to object {object_id}, which has no mesh")
        if object_id not in self._known:
            self._known[object_id] = fetch_geometry(self._objects[object_id])
        return self._known[object_id]

    def beams_of(self, object_id: int, matrix: Floats) -> PrintedBeams | None:
        """Return the beams of an object under a ``(4, 4)`` matrix, as readers of the Beam Lattice extension make them.

        Beams shorter than the least length that the file states are ignored, as the extension demands.
        """
        from lib3mf import Lib3MF

        lattice = self._objects[object_id].BeamLattice()
        if not lattice.GetBeamCount():
            return None
        struts, radii, caps = fetch_capped_beams(lattice)
        ends = placed(self.of(object_id)[0], matrix)[struts]
        long = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) >= lattice.GetMinLength()
        mode, clipping = lattice.GetClipping()
        round_caps: Bools = (caps == int(Lib3MF.BeamLatticeCapMode.Sphere)).all(axis=1)
        return PrintedBeams(
            ends[long],
            radii[long] * np.cbrt(abs(np.linalg.det(matrix[:3, :3]))),
            round_caps[long],
            has_balls=lattice.GetBallOptions()[0] != int(Lib3MF.BeamLatticeBallMode.BeamLatticeBallModeNone),
            clipping=self._clipping(clipping, matrix)
            if mode != Lib3MF.BeamLatticeClipMode.NoClipMode
            else None,
            keeps_inside=mode != Lib3MF.BeamLatticeClipMode.Outside,
        )

    def _clipping(self, unique_id: int, matrix: Floats) -> Mesh:
        vertices, triangles = fetch_geometry(self._model.GetMeshObjectByID(unique_id))
        return Mesh(placed(vertices, matrix), triangles)


def placed(vertices: Floats, matrix: Floats) -> Floats:
    """Return vertices ``(n, 3)`` under a ``(4, 4)`` matrix for column vectors."""
    if np.array_equal(matrix, np.eye(4)):
        return vertices
    return np.asarray(vertices @ matrix[:3, :3].T + matrix[:3, 3])
