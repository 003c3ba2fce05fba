"""Load a model with lib3mf and fetch whole arrays from it; lib3mf's getters make a Python object per number."""

import ctypes
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from amprep.arrays import Floats, MeshArrays

if TYPE_CHECKING:
    from lib3mf import Lib3MF

_UNITS = (
    ("micrometres", 0.001),
    ("millimetres", 1.0),
    ("centimetres", 10.0),
    ("inches", 25.4),
    ("feet", 304.8),
    ("metres", 1000.0),
)
"""Name and length in mm of each unit, in the order of lib3mf's `ModelUnit`."""


class LoadedModel(NamedTuple):
    """A model in lib3mf's memory, and lib3mf's warnings about it."""

    model: "Lib3MF.Model"
    warnings: tuple[str, ...]


class RawMesh(NamedTuple):
    """Arrays of a mesh object, unchanged.

    Attributes
    ----------
    vertices
        ``(n, 3)`` float64 in the file's unit; the values are those of float32.
    triangles
        ``(m, 3)`` int64.
    properties
        ``(m, 4)`` int64: unique id of the property resource (0 for none), and the property at each corner.
    """

    vertices: Floats
    triangles: NDArray[np.int64]
    properties: NDArray[np.int64]


def load_model(package: bytes) -> LoadedModel:
    """Read a package from memory, in lib3mf's tolerant mode.

    Raises
    ------
    lib3mf.Lib3MF.ELib3MFException
        If lib3mf refuses it.
    """
    import lib3mf

    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(False)
    start = ctypes.cast(ctypes.c_char_p(package), ctypes.POINTER(ctypes.c_uint8))
    _call(reader, "lib3mf_reader_readfrombuffer", ctypes.c_uint64(len(package)), start)
    warnings = dict.fromkeys(reader.GetWarning(index)[1] for index in range(reader.GetWarningCount()))
    return LoadedModel(model, tuple(warnings))


def unit_of(model: "Lib3MF.Model") -> tuple[str, float]:
    """Return the name of the model's unit of length and its length in mm."""
    return _UNITS[int(model.GetUnit())]


def fetch_mesh(mesh: "Lib3MF.MeshObject") -> RawMesh:
    """Fetch the arrays of a mesh object."""
    from lib3mf import Lib3MF

    name = "lib3mf_meshobject_getalltriangleproperties"
    properties = _fetch(mesh, name, Lib3MF.TriangleProperties, np.uint32, 4)
    return RawMesh(*fetch_geometry(mesh), properties.astype(np.int64))


def fetch_geometry(mesh: "Lib3MF.MeshObject") -> MeshArrays:
    """Fetch vertices ``(n, 3)``, in the file's unit, and triangles ``(m, 3)`` of a mesh object."""
    from lib3mf import Lib3MF

    vertices = _fetch(mesh, "lib3mf_meshobject_getvertices", Lib3MF.Position, np.float32, 3)
    triangles = _fetch(mesh, "lib3mf_meshobject_gettriangleindices", Lib3MF.Triangle, np.uint32, 3)
    return vertices.astype(np.float64), triangles.astype(np.int64)


def fetch_beams(lattice: "Lib3MF.BeamLattice") -> tuple[NDArray[np.int64], Floats]:
    """Fetch the beams of a lattice: the vertices ``(m, 2)`` and radii ``(m, 2)`` of both ends, in the file's unit."""
    struts, radii, _ = fetch_capped_beams(lattice)
    return struts, radii


def fetch_capped_beams(
    lattice: "Lib3MF.BeamLattice",
) -> tuple[NDArray[np.int64], Floats, NDArray[np.int32]]:
    """Fetch the beams of a lattice as `fetch_beams` does, and the caps ``(m, 2)`` of both ends, numbered by lib3mf."""
    from lib3mf import Lib3MF

    dtype = np.dtype([("ends", np.uint32, 2), ("radii", np.float64, 2), ("caps", np.int32, 2)])
    beams = _fetch(lattice, "lib3mf_beamlattice_getbeams", Lib3MF.Beam, dtype, 1).reshape(-1)
    return beams["ends"].astype(np.int64), beams["radii"].astype(np.float64), beams["caps"]


def _fetch(thing: Any, name: str, record: type, dtype: DTypeLike, width: int) -> NDArray[Any]:
    """Let a getter of lib3mf fill an array; called without an array, it returns the number of records."""
    needed = ctypes.c_uint64(0)
    pointer: Any = ctypes.POINTER(record)
    _call(thing, name, ctypes.c_uint64(0), needed, pointer())
    array = np.empty((needed.value, width), dtype)
    if needed.value:
        _call(thing, name, ctypes.c_uint64(needed.value), needed, array.ctypes.data_as(pointer))
    return array


def _call(thing: Any, name: str, *arguments: Any) -> None:
    """Call a function of lib3mf's C interface on an object; raise its error, if any."""
    wrapper = thing._wrapper  # noqa: SLF001 - lib3mf offers no other way to its bulk functions
    function: Callable[..., int] = getattr(wrapper.lib, name)
    wrapper.checkError(thing, function(thing._handle, *arguments))  # noqa: SLF001
