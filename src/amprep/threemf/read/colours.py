"""Read the colours and materials of a 3MF mesh: base materials and colour groups, of the object or its triangles."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from amprep.model.part import Appearance
from amprep.threemf.read.arrays import RawMesh

if TYPE_CHECKING:
    from lib3mf import Lib3MF

NO_COLOUR = -1

_NO_RESOURCE = 0


class MeshColours(NamedTuple):
    """Colours and materials of a mesh.

    Attributes
    ----------
    corners
        ``(m, 3)`` int64, 0xRRGGBBAA at each corner of each triangle, `NO_COLOUR` where there is none.
    materials
        Names of the base materials used.
    incomplete
        True if the file states more than is kept: textures, composite materials, several properties at once.
    """

    corners: NDArray[np.int64]
    materials: frozenset[str]
    incomplete: bool


def mesh_colours(model: "Lib3MF.Model", mesh: "Lib3MF.MeshObject", raw: RawMesh) -> MeshColours:
    """Return the colours of a mesh object; triangles without a property of their own have the object's.

    Parameters
    ----------
    model
        Holds the property resources.
    mesh, raw
        The object and its arrays.
    """
    resource, chosen = _with_default(mesh, raw)
    corners = np.full((len(raw.triangles), 3), NO_COLOUR, np.int64)
    materials: set[str] = set()
    incomplete = False
    for group in np.unique(resource[resource != _NO_RESOURCE]).tolist():
        rows = resource == group
        known = _properties(model, group)
        incomplete = incomplete or known is None
        if known:
            ids, palette = np.array(list(known)), np.array([colour for colour, _ in known.values()])
            order = np.argsort(ids)
            found = order[np.searchsorted(ids, chosen[rows], sorter=order).clip(max=len(ids) - 1)]
            corners[rows] = np.where(ids[found] == chosen[rows], palette[found], NO_COLOUR)
            materials |= {known[int(ids[index])][1] for index in np.unique(found)} - {""}
    return MeshColours(corners, frozenset(materials), incomplete)


def appearance_of(colours: list[MeshColours]) -> Appearance:
    """Return the appearance of a part whose mesh joins meshes with these colours, in this order."""
    corners = np.concatenate([each.corners for each in colours])
    materials = frozenset[str]().union(*(each.materials for each in colours))
    material = next(iter(materials)) if len(materials) == 1 else None
    first = int(corners[0, 0]) if len(corners) else NO_COLOUR
    if (corners == first).all():
        return Appearance(None if first == NO_COLOUR else f"#{first:08X}", material)
    return Appearance(None, material, corners)


def rgba(colour: "Lib3MF.Color") -> int:
    """Return a colour as 0xRRGGBBAA."""
    return int(colour.Red) << 24 | int(colour.Green) << 16 | int(colour.Blue) << 8 | int(colour.Alpha)


def _with_default(mesh: "Lib3MF.MeshObject", raw: RawMesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return resource ``(m,)`` and properties ``(m, 3)`` of the triangles, with the object's where they have none."""
    if len(raw.properties) != len(raw.triangles):
        raw = raw._replace(properties=np.zeros((len(raw.triangles), 4), np.int64))
    group, value, given = mesh.GetObjectLevelProperty()
    without = raw.properties[:, :1] == _NO_RESOURCE
    filled = np.where(without & given, [group, value, value, value], raw.properties)
    return filled[:, 0], filled[:, 1:]


def _properties(model: "Lib3MF.Model", group: int) -> dict[int, tuple[int, str]] | None:
    """Return property id -> (0xRRGGBBAA, material name) of a resource; None for an unsupported type of resource."""
    from lib3mf import Lib3MF

    kind = model.GetPropertyTypeByID(group)
    if kind == Lib3MF.PropertyType.BaseMaterial:
        materials = model.GetBaseMaterialGroupByID(group)
        return {
            index: (rgba(materials.GetDisplayColor(index)), materials.GetName(index))
            for index in materials.GetAllPropertyIDs()
        }
    if kind == Lib3MF.PropertyType.Colors:
        palette = model.GetColorGroupByID(group)
        return {index: (rgba(palette.GetColor(index)), "") for index in palette.GetAllPropertyIDs()}
    return None
